// SPDX-License-Identifier: Apache-2.0
// How a build runs its jobs: on how many threads, within which memory, with progress, until it is cancelled.
#pragma once

#include <cstddef>
#include <functional>
#include <string_view>

#include "base/parallel.h"
#include "ibr/log.h"

namespace ibr {

class BuildJobs {
 public:
  /// `threads`: 0 for all cores. `memory`: bytes that all may take, 0 for half of what there is. `progress` may be
  /// empty; it must outlive the object.
  BuildJobs(int threads, double memory, const ProgressCallback& progress)
      : threads_(threads), memory_(memoryBudget(memory)), progress_(progress) {}

  /// Reports progress. Throws Error{cancelled} when it is answered with no.
  void step(std::string_view stage, std::size_t done, std::size_t total) const;

  /// job(0) … job(count − 1), each once, on no more threads than the memory holds jobs of `bytesEach`, beside what is
  /// held already and the `bytesKept` that each leaves behind. Throws what a job throws, and Error{cancelled}; jobs
  /// that have started are waited for.
  void runAll(std::string_view stage, std::size_t count, double bytesEach, const std::function<void(std::size_t)>& job,
              double bytesKept = 0) const;

 private:
  bool wanted(std::string_view stage, std::size_t done, std::size_t total) const;

  int threads_;
  double memory_;
  const ProgressCallback& progress_;
};

/// While it lives OpenCV uses one thread: jobs are what runs side by side, and optical flow depends on how many threads
/// share it. A setting of the process: one such object at a time.
class SingleThreadedOpenCv {
 public:
  SingleThreadedOpenCv();
  SingleThreadedOpenCv(const SingleThreadedOpenCv&) = delete;
  SingleThreadedOpenCv& operator=(const SingleThreadedOpenCv&) = delete;
  ~SingleThreadedOpenCv();

 private:
  int before_;
};

}  // namespace ibr
