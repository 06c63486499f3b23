// SPDX-License-Identifier: Apache-2.0
// Writes pictures on a thread of its own, so that encoding and disks do not delay frames.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <filesystem>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace ibr::app {

struct PictureJob {
  std::string name;                                           // file or folder, for errors that name no file
  std::function<std::vector<std::filesystem::path>()> write;  // returns the files; runs on the writer's thread
  bool required = false;                                      // the caller fails if the picture cannot be written
};

struct PictureResult {
  std::vector<std::filesystem::path> files;
  std::exception_ptr error;  // null if the files were written; else an Error that names a file
  bool required = false;     // of the job
};

/// Runs jobs one by one, in the order of add(). Threading: one thread uses the object. Without jobs, no call allocates.
class PictureWriter {
 public:
  /// `onResult` is called on the writer's thread after each result is available.
  explicit PictureWriter(std::function<void()> onResult = {}, std::size_t maxQueued = 4);
  PictureWriter(const PictureWriter&) = delete;
  PictureWriter& operator=(const PictureWriter&) = delete;
  ~PictureWriter();  // runs all queued jobs first

  /// Queues a job. Waits while `maxQueued` jobs wait for the thread.
  void add(PictureJob job);
  bool hasResults() const noexcept { return hasResults_; }
  /// Returns the results since the last call, in the order of the jobs. Does not wait for jobs.
  std::vector<PictureResult> takeResults();
  /// Waits until a result is available or all jobs have run. Returns the results since the last call.
  std::vector<PictureResult> waitForResults();
  /// Waits until all jobs have run. Returns their results.
  std::vector<PictureResult> finish();

 private:
  void run();

  const std::function<void()> onResult_;
  const std::size_t maxQueued_;
  std::mutex mutex_;  // guards queue_, results_, running_ and ending_
  std::condition_variable changed_;
  std::deque<PictureJob> queue_;
  std::vector<PictureResult> results_;
  std::atomic<bool> hasResults_ = false;
  bool running_ = false, ending_ = false;
  std::thread thread_;  // last: uses all members above
};

}  // namespace ibr::app
