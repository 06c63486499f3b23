// SPDX-License-Identifier: Apache-2.0
// A gate at which threads wait until the test opens it.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>

namespace ibr::test {

class Gate {
 public:
  void open() {
    const std::lock_guard lock(mutex_);
    isOpen_ = true;
    changed_.notify_all();
  }
  void pass() {
    std::unique_lock lock(mutex_);
    ++arrivals_;
    changed_.notify_all();
    changed_.wait(lock, [&] { return isOpen_; });
  }
  /// Waits until pass() has been called so often. Returns false after two minutes.
  bool waitForArrivals(int count) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::minutes(2), [&] { return arrivals_ >= count; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool isOpen_ = false;
  int arrivals_ = 0;
};

}  // namespace ibr::test
