// SPDX-License-Identifier: Apache-2.0
#include "author/build_jobs.h"

#include <opencv2/core/utility.hpp>

#include "author/parallel.h"
#include "base/check.h"

namespace ibr {

bool BuildJobs::wanted(std::string_view stage, std::size_t done, std::size_t total) const {
  return !progress_ || progress_({stage, done, total});
}

void BuildJobs::step(std::string_view stage, std::size_t done, std::size_t total) const {
  check(wanted(stage, done, total), ErrorCode::cancelled, "the build was cancelled while {}", stage);
}

void BuildJobs::runAll(std::string_view stage, std::size_t count, double bytesEach,
                       const std::function<void(std::size_t)>& job) const {
  const bool finished = runJobs(count, threadsFor(threads_, bytesEach), job,
                                [&](std::size_t done) { return wanted(stage, done, count); });
  check(finished, ErrorCode::cancelled, "the build was cancelled while {}; called again it goes on from there", stage);
}

SingleThreadedOpenCv::SingleThreadedOpenCv() : before_(cv::getNumThreads()) {
  cv::setNumThreads(1);
}
SingleThreadedOpenCv::~SingleThreadedOpenCv() {
  cv::setNumThreads(before_);
}

}  // namespace ibr
