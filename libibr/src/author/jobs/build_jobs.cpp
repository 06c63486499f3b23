// SPDX-License-Identifier: Apache-2.0
#include "author/jobs/build_jobs.h"

#include <opencv2/core/utility.hpp>

#include <algorithm>

#include "base/check.h"
#include "base/usage.h"

namespace ibr {

bool BuildJobs::reportProgress(std::string_view stage, std::size_t done, std::size_t total) const {
  return !progress_ || progress_({stage, done, total});
}

void BuildJobs::step(std::string_view stage, std::size_t done, std::size_t total) const {
  check(reportProgress(stage, done, total), ErrorCode::cancelled, "the build was cancelled while {}", stage);
}

void BuildJobs::runAll(std::string_view stage, std::size_t count, double bytesEach,
                       const std::function<void(std::size_t)>& job, double retainedBytes) const {
  const double left = memory_ - residentMemory() - retainedBytes * double(count);
  const bool finished = runJobs(count, threadsFor(threads_, bytesEach, std::max(left, 1.0)), job,
                                [&](std::size_t done) { return reportProgress(stage, done, count); });
  check(finished, ErrorCode::cancelled, "the build was cancelled while {}; start again to resume", stage);
}

SingleThreadedOpenCv::SingleThreadedOpenCv() : before_(cv::getNumThreads()) {
  cv::setNumThreads(1);
}
SingleThreadedOpenCv::~SingleThreadedOpenCv() {
  cv::setNumThreads(before_);
}

}  // namespace ibr
