// SPDX-License-Identifier: Apache-2.0
// Jobs on other threads, most urgent first: on threads of the queue, or on threads of the caller.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>
#include <thread>
#include <vector>

namespace ibr {

/// One thread at a time, the owner's, calls the member functions. Except for the constructor, they allocate nothing and
/// wait for no job, unless stated.
class JobQueue {
 public:
  /// Calls a function on another thread, at some time, or destroys it without a call.
  using Executor = std::function<void(std::function<void()>)>;

  enum class JobState : std::uint8_t { idle, queued, running };

  /// Work of one kind that may be added again once it is idle. Must live until it is idle.
  class Job {
   public:
    Job(const Job&) = delete;
    Job& operator=(const Job&) = delete;

    /// Called on any thread, by one thread at a time. `stop`: after requestStop(), also by the queue's destruction; the
    /// result is not needed.
    virtual void run(const std::stop_token& stop) noexcept = 0;

   protected:
    Job() = default;
    ~Job() = default;

   private:
    friend class JobQueue;
    JobState state_ = JobState::idle;
    std::uint64_t order_ = 0;
  };

  /// `threads`: maximum number of jobs that run at a time; 0: add() runs jobs at once, on the calling thread.
  /// `executor`: calls functions that run jobs until the queue is empty; empty: the queue has threads of its own.
  /// `capacity`: maximum number of queued jobs.
  JobQueue(unsigned threads, Executor executor, std::size_t capacity);
  JobQueue(const JobQueue&) = delete;
  JobQueue& operator=(const JobQueue&) = delete;
  /// Drops queued jobs, requests the stop of running ones, and waits for these. Functions that the executor still holds
  /// may be called or destroyed later; they have no effect.
  ~JobQueue();

  /// Maximum number of jobs that run at a time; 0: add() runs them at once. Less than requested where the system has no
  /// more threads.
  unsigned threads() const noexcept;

  /// Queues an idle job. Jobs of lower order run first.
  void add(Job& job, std::uint64_t order);
  /// Returns true if the job was queued; it is idle then.
  bool withdraw(Job& job);
  /// An idle job's results are visible to the calling thread.
  JobState state(const Job& job) const;
  /// Runs the job on the calling thread if it is queued; waits for it if it is running.
  void finish(Job& job);
  /// Requests the stop of running jobs and of all jobs that are added later.
  void requestStop() noexcept;

 private:
  struct Control;
  struct Ticket;

  std::shared_ptr<Control> control_;  // shared with functions that the executor holds
  std::vector<std::thread> threads_;
};

}  // namespace ibr
