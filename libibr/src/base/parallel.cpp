// SPDX-License-Identifier: Apache-2.0
#include "base/parallel.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <limits>
#include <mutex>
#include <thread>
#include <vector>

#include "base/usage.h"

namespace ibr {

bool runJobs(std::size_t count, int threads, const std::function<void(std::size_t)>& job,
             const std::function<bool(std::size_t)>& report) {
  std::mutex mutex;
  std::condition_variable changed;
  std::size_t next = 0, done = 0, failed = std::numeric_limits<std::size_t>::max();
  int running = 0;
  bool stop = false;
  std::exception_ptr error;
  auto work = [&] {
    std::unique_lock lock(mutex);
    while (!stop && next < count) {
      const std::size_t mine = next++;
      lock.unlock();
      std::exception_ptr caught;
      try {
        job(mine);
      } catch (...) {
        caught = std::current_exception();
      }
      lock.lock();
      ++done;
      if (caught) {
        stop = true;
        if (mine < failed) failed = mine, error = caught;
      }
      changed.notify_one();
    }
    --running;
    changed.notify_one();
  };

  bool wanted = report(0);
  if (wanted) {
    const std::size_t workers = std::min(count, std::size_t(std::max(threads, 1)));
    running = int(workers);
    std::vector<std::jthread> pool;
    for (std::size_t i = 0; i < workers; ++i) pool.emplace_back(work);
    std::unique_lock lock(mutex);
    for (bool last = false; !last;) {  // jobs that ended before this thread looked are reported, too
      if (running > 0) changed.wait_for(lock, std::chrono::milliseconds(200));
      last = running == 0;
      const std::size_t now = done;
      if (!wanted || stop) continue;
      lock.unlock();
      wanted = report(now);
      lock.lock();
      stop = stop || !wanted;
    }
  }
  if (error) std::rethrow_exception(error);
  return wanted;
}

int threadsFor(int wanted, double bytesEach, double memory) {
  const int maxThreads = wanted > 0 ? wanted : std::max(1, int(std::thread::hardware_concurrency()));
  return int(std::clamp(memoryBudget(memory) / std::max(bytesEach, 1.0), 1.0, double(maxThreads)));
}

double memoryBudget(double wanted) {
  constexpr double kShare = 0.5;  // the rest is left to other programs and to the system's file cache
  return wanted > 0 ? wanted : kShare * memoryLimit();
}

}  // namespace ibr
