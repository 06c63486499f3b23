// SPDX-License-Identifier: Apache-2.0
#include "base/job_queue.h"

#include <catch2/catch.hpp>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <thread>
#include <vector>

#include "support/gate.h"

using namespace ibr;
using test::Gate;
using JobState = JobQueue::JobState;

namespace {

struct Log {
  std::mutex mutex;
  std::vector<int> runs;
};

/// Records its runs. With a gate, it waits until the gate is open or its stop is requested.
struct Numbered final : JobQueue::Job {
  Numbered(int of, Log& into, Gate* at = nullptr) : number(of), log(into), gate(at) {}
  void run(const std::stop_token& stop) noexcept override {
    thread = std::this_thread::get_id();
    if (gate) {
      const std::stop_callback opens(stop, [this] { gate->open(); });
      gate->pass();
    }
    stopped = stop.stop_requested();
    const std::lock_guard lock(log.mutex);
    log.runs.push_back(number);
  }
  int number;
  Log& log;
  Gate* gate;
  std::thread::id thread;
  bool stopped = false;
};

/// Holds functions until the test calls or drops them.
struct Held {
  JobQueue::Executor executor() {
    return [this](std::function<void()> call) { calls.push_back(std::move(call)); };
  }
  void callFirst() {
    std::function<void()> call = std::move(calls.front());
    calls.pop_front();
    std::thread(std::move(call)).join();
  }
  std::deque<std::function<void()>> calls;
};

}  // namespace

TEST_CASE("a queue without threads runs jobs on the calling thread at once") {
  Log log;
  Numbered job(1, log);
  JobQueue queue(0, {}, 1);
  queue.add(job, 5);
  CHECK(log.runs == std::vector{1});
  CHECK(job.thread == std::this_thread::get_id());
  CHECK(queue.state(job) == JobState::idle);
  queue.add(job, 5);
  queue.finish(job);
  CHECK(log.runs == std::vector{1, 1});
}

TEST_CASE("jobs of lower order run first") {
  Log log;
  Gate gate;
  Numbered first(0, log, &gate);
  std::deque<Numbered> jobs;
  JobQueue queue(1, {}, 8);
  queue.add(first, 0);
  REQUIRE(gate.waitForArrivals(1));
  for (const int number : {4, 2, 3, 1}) queue.add(jobs.emplace_back(number, log), std::uint64_t(number));
  CHECK(queue.state(jobs[0]) == JobState::queued);
  gate.open();
  for (;;) {  // the calling thread must not help
    const std::lock_guard lock(log.mutex);
    if (log.runs.size() == 5) break;
  }
  for (Numbered& job : jobs) queue.finish(job);
  CHECK(log.runs == std::vector{0, 1, 2, 3, 4});
  for (const Numbered& job : jobs) CHECK(job.thread != std::this_thread::get_id());
}

TEST_CASE("a withdrawn job does not run, and a job that is finished early runs on the calling thread") {
  Log log;
  Gate gate;
  Numbered busy(0, log, &gate), withdrawn(1, log), finished(2, log);
  JobQueue queue(1, {}, 4);
  queue.add(busy, 0);
  REQUIRE(gate.waitForArrivals(1));
  CHECK_FALSE(queue.withdraw(busy));
  CHECK(queue.state(busy) == JobState::running);
  queue.add(withdrawn, 1);
  queue.add(finished, 2);
  CHECK(queue.withdraw(withdrawn));
  CHECK_FALSE(queue.withdraw(withdrawn));
  CHECK(queue.state(withdrawn) == JobState::idle);
  queue.finish(finished);
  CHECK(finished.thread == std::this_thread::get_id());
  gate.open();
  queue.finish(busy);
  CHECK(log.runs == std::vector{2, 0});
  CHECK_FALSE(busy.stopped);
}

TEST_CASE("the destructor drops queued jobs, stops running ones and waits for them") {
  Log log;
  Gate gate;
  Numbered running(0, log, &gate), dropped(1, log);
  std::optional<JobQueue> queue(std::in_place, 1u, JobQueue::Executor{}, std::size_t(4));
  queue->add(running, 0);
  REQUIRE(gate.waitForArrivals(1));
  queue->add(dropped, 1);
  queue.reset();
  CHECK(log.runs == std::vector{0});
  CHECK(running.stopped);
}

TEST_CASE("running jobs see a requested stop") {
  Log log;
  Gate gate;
  Numbered running(0, log, &gate);
  JobQueue queue(1, {}, 1);
  queue.add(running, 0);
  REQUIRE(gate.waitForArrivals(1));
  queue.requestStop();
  queue.finish(running);
  CHECK(running.stopped);
}

TEST_CASE("an executor gets at most as many functions at a time as the queue has threads, and each empties the queue") {
  Log log;
  Held held;
  std::deque<Numbered> jobs;
  JobQueue queue(2, held.executor(), 8);
  for (int number = 0; number < 5; ++number) queue.add(jobs.emplace_back(number, log), std::uint64_t(5 - number));
  CHECK(held.calls.size() == 2);
  CHECK(log.runs.empty());
  held.callFirst();
  CHECK(log.runs == std::vector{4, 3, 2, 1, 0});
  held.callFirst();  // finds an empty queue
  queue.add(jobs[0], 0);
  REQUIRE(held.calls.size() == 1);
  held.callFirst();
  CHECK(log.runs.size() == 6);
  CHECK(jobs[0].thread != std::this_thread::get_id());
}

TEST_CASE("a function that the executor destroys is handed over again by the next job") {
  Log log;
  Held held;
  Numbered first(1, log), second(2, log);
  JobQueue queue(1, held.executor(), 2);
  queue.add(first, 1);
  REQUIRE(held.calls.size() == 1);
  held.calls.clear();
  CHECK(queue.state(first) == JobState::queued);
  queue.add(second, 2);
  REQUIRE(held.calls.size() == 1);
  held.callFirst();
  CHECK(log.runs == std::vector{1, 2});
}

TEST_CASE("functions that an executor calls or destroys after the queue is gone have no effect") {
  Log log;
  Held held;
  {
    Numbered job(1, log), other(2, log);
    JobQueue queue(2, held.executor(), 2);
    queue.add(job, 0);
    queue.add(other, 0);
    REQUIRE(held.calls.size() == 2);
  }
  const std::function<void()> copy = held.calls.front();
  held.callFirst();
  copy();
  held.calls.clear();
  CHECK(log.runs.empty());
}

TEST_CASE("no job waits for the next one while an executor's function ends") {
  Log log;
  std::mutex mutex;
  std::condition_variable_any added;
  std::deque<std::function<void()>> calls;
  std::jthread thread([&](const std::stop_token& stop) {
    std::unique_lock lock(mutex);
    while (added.wait(lock, stop, [&] { return !calls.empty(); })) {
      std::function<void()> call = std::move(calls.front());
      calls.pop_front();
      lock.unlock();
      call();
      call = nullptr;
      lock.lock();
    }
  });
  Numbered job(1, log);
  JobQueue queue(
      1,
      [&](std::function<void()> call) {
        const std::lock_guard lock(mutex);
        calls.push_back(std::move(call));
        added.notify_one();
      },
      1);
  const auto late = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  for (int round = 0; round < 50000; ++round) {
    queue.add(job, 0);
    while (queue.state(job) != JobState::idle)
      if (std::chrono::steady_clock::now() > late) FAIL("the job still waits in round " << round);
  }
}

TEST_CASE("an executor that throws or runs a job at once is tolerated") {
  Log log;
  Numbered job(1, log);
  bool throws = true;
  JobQueue queue(
      1,
      [&](std::function<void()> call) {
        if (throws) throw std::runtime_error("no thread");
        call();
      },
      1);
  CHECK_NOTHROW(queue.add(job, 0));
  CHECK(queue.state(job) == JobState::queued);
  CHECK(queue.withdraw(job));
  throws = false;
  queue.add(job, 0);
  CHECK(log.runs == std::vector{1});
}

TEST_CASE("many jobs on many threads run once each") {
  Log log;
  std::deque<Numbered> jobs;
  for (int number = 0; number < 16; ++number) jobs.emplace_back(number, log);
  JobQueue queue(4, {}, jobs.size());
  for (int round = 0; round < 200; ++round) {
    for (Numbered& job : jobs) queue.add(job, std::uint64_t(job.number));
    for (Numbered& job : jobs)
      if ((job.number + round) % 3 == 0 && queue.withdraw(job)) queue.add(job, 0);
    for (Numbered& job : jobs) queue.finish(job);
  }
  CHECK(log.runs.size() == 200 * jobs.size());
}
