// SPDX-License-Identifier: Apache-2.0
// Runs a build's jobs in parallel within a memory limit, with progress and cancellation.
#pragma once

#include <cstddef>
#include <functional>
#include <string_view>

#include "base/parallel.h"
#include "ibr/log.h"

namespace ibr {

class BuildJobs {
 public:
  /// `threads`: 0 for all cores. `memory`: maximum bytes of all jobs together; 0: half of the available memory.
  /// `progress` may be empty; it must outlive the object.
  BuildJobs(int threads, double memory, const ProgressCallback& progress)
      : threads_(threads), memory_(memoryBudget(memory)), progress_(progress) {}

  /// Reports progress. Throws Error{cancelled} if the callback returns false.
  void step(std::string_view stage, std::size_t done, std::size_t total) const;

  /// Runs job(0) … job(count − 1), each once. The number of threads is limited so that jobs of `bytesEach`, the
  /// process's current memory and `retainedBytes` left behind by each job fit the memory. Throws what a job throws, and
  /// Error{cancelled}; waits for jobs that have started.
  void runAll(std::string_view stage, std::size_t count, double bytesEach, const std::function<void(std::size_t)>& job,
              double retainedBytes = 0) const;

 private:
  bool reportProgress(std::string_view stage, std::size_t done, std::size_t total) const;

  int threads_;
  double memory_;
  const ProgressCallback& progress_;
};

/// Limits OpenCV to one thread during its lifetime: jobs run in parallel instead, and optical flow depends on the
/// number of threads. The setting is process-wide: only one such object may exist at a time.
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
