// SPDX-License-Identifier: Apache-2.0
#include "optimise/workers.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace ibr {

void forEachInParallel(std::size_t count, int threads, const std::function<void(std::size_t)>& work,
                       std::size_t block) {
  const std::size_t cores = threads > 0 ? std::size_t(threads) : std::max(1u, std::thread::hardware_concurrency());
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex guard;
  const auto run = [&] {
    try {
      for (std::size_t first; (first = next.fetch_add(block)) < count;)
        for (std::size_t i = first; i < std::min(first + block, count); ++i) work(i);
    } catch (...) {
      const std::lock_guard lock(guard);
      if (!failure) failure = std::current_exception();
      next = count;
    }
  };
  {
    std::vector<std::jthread> others;
    for (std::size_t t = 1; t < std::min(cores, (count + block - 1) / block); ++t) others.emplace_back(run);
    run();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace ibr
