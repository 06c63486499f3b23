// SPDX-License-Identifier: Apache-2.0
// Executor of a GpuScene whose jobs run when the test wants.
#pragma once

#include <deque>
#include <functional>
#include <thread>
#include <utility>

#include "ibr/gpu_scene.h"

namespace ibr::test {

/// Keeps jobs until they are run, each on a new thread, which is waited for: results are deterministic.
class HandExecutor {
 public:
  HandExecutor() = default;
  HandExecutor(const HandExecutor&) = delete;
  HandExecutor& operator=(const HandExecutor&) = delete;

  JobExecutor executor() {
    return [this](std::function<void()> job) { jobs.push_back(std::move(job)); };
  }
  void runAll() {
    while (!jobs.empty()) {
      std::function<void()> job = std::move(jobs.front());
      jobs.pop_front();
      std::thread(std::move(job)).join();
    }
  }

  std::deque<std::function<void()>> jobs;
};

}  // namespace ibr::test
