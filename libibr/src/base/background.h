// SPDX-License-Identifier: Apache-2.0
// A value that a thread of its own computes, with cancellation.
#pragma once

#include <chrono>
#include <functional>
#include <future>
#include <stop_token>
#include <utility>

namespace ibr {

/// Threading: one thread uses the object. Destruction and assignment request a stop and wait until the work has ended.
template <class T>
class Background {
 public:
  Background() = default;
  /// Starts the work on a thread of its own. The work should end soon after a stop was requested, by any exception.
  explicit Background(std::function<T(const std::stop_token&)> work)
      : value_(std::async(std::launch::async,
                          [work = std::move(work), stop = stop_.get_token()] { return work(stop); })) {}
  Background(Background&&) noexcept = default;
  Background& operator=(Background&& other) noexcept {
    finish();
    stop_ = std::move(other.stop_);
    value_ = std::move(other.value_);
    return *this;
  }
  ~Background() { finish(); }

  /// True from the start of the work until take().
  bool isRunning() const noexcept { return value_.valid(); }
  /// True once take() does not wait.
  bool isReady() const { return isRunning() && value_.wait_for(std::chrono::seconds(0)) == std::future_status::ready; }
  void requestStop() noexcept { stop_.request_stop(); }
  /// Waits and returns the value, or throws what the work has thrown. Precondition: isRunning().
  T take() { return value_.get(); }

 private:
  void finish() noexcept {
    if (!isRunning()) return;
    requestStop();
    value_.wait();
  }

  std::stop_source stop_;
  std::future<T> value_;
};

}  // namespace ibr
