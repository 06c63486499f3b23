// SPDX-License-Identifier: Apache-2.0
// Reads of a constructor: in jobs, a few at a time, used in order.
#pragma once

#include <cstddef>
#include <exception>
#include <optional>
#include <stop_token>
#include <utility>
#include <vector>

#include "base/check.h"
#include "base/job_queue.h"

namespace ibr {

/// Calls read(i, stop) for i = 0 … count − 1 in jobs of the queue, and use(i, result) on the calling thread in order.
/// At most two more results than the queue has threads are in memory at a time.
/// The calling thread reads, too, where it would wait. Throws the first exception of `read` or `use`, and
/// Error{cancelled} once `stop` is requested; running reads are then asked to stop.
template <class Result, class Read, class Use>
void readInOrder(JobQueue& jobs, std::size_t count, const std::stop_token& stop, const Read& read, const Use& use) {
  struct ReadJob final : JobQueue::Job {
    void run(const std::stop_token& reading) noexcept override try { result = (*read)(index, reading); } catch (...) {
      error = std::current_exception();
    }
    const Read* read = nullptr;
    std::size_t index = 0;
    std::optional<Result> result;
    std::exception_ptr error;
  };
  struct Reads {
    explicit Reads(JobQueue& of) : jobs(of), all(of.threads() > 0 ? of.threads() + 2 : 1) {}
    ~Reads() {
      for (ReadJob& job : all) jobs.withdraw(job);
      for (ReadJob& job : all)
        if (jobs.state(job) != JobQueue::JobState::idle) {
          jobs.requestStop();
          jobs.finish(job);
        }
    }
    ReadJob& operator[](std::size_t i) { return all[i % all.size()]; }
    JobQueue& jobs;
    std::vector<ReadJob> all;
  } reads(jobs);
  for (std::size_t next = 0, i = 0; i < count; ++i) {
    for (; next < count && next < i + reads.all.size(); ++next) {
      ReadJob& job = reads[next];
      job.read = &read;
      job.index = next;
      jobs.add(job, next);
    }
    check(!stop.stop_requested(), ErrorCode::cancelled, "opening the scene was cancelled");
    ReadJob& job = reads[i];
    jobs.finish(job);
    if (job.error) std::rethrow_exception(job.error);
    use(i, std::move(*std::exchange(job.result, std::nullopt)));
  }
}

}  // namespace ibr
