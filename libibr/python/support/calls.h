// SPDX-License-Identifier: Apache-2.0
// Long calls into the library: the interpreter's lock is released, progress reaches Python, and Ctrl-C or an exception
// of the callback cancels the call.
#pragma once

#include <pybind11/pybind11.h>

#include <exception>
#include <utility>

#include "ibr/log.h"

namespace ibr::python {

/// Returns a callback that passes messages to Python's logger "ibr", from any thread.
LogCallback logToPython();

/// Calls `function()` without the interpreter's lock.
template <class F>
auto unlocked(F&& function) {
  const pybind11::gil_scoped_release released;
  return function();
}

/// Truth of a callback's result; None is true.
bool goesOn(const pybind11::object& result);

/// One call. `progress` is None or a Python function of (stage, done, total); its result False cancels.
class LongCall {
 public:
  explicit LongCall(pybind11::object progress) : progress_(std::move(progress)) {}
  LongCall(const LongCall&) = delete;
  LongCall& operator=(const LongCall&) = delete;

  /// Calls `function(ProgressCallback)` without the interpreter's lock. An exception of the Python function, or
  /// KeyboardInterrupt, is thrown in place of the library's Error{cancelled}.
  template <class F>
  auto run(F&& function) {
    try {
      auto result =
          unlocked([&] { return function(ProgressCallback([this](const Progress& now) { return report(now); })); });
      rethrow();
      return result;
    } catch (...) {
      rethrow();
      throw;
    }
  }

  /// Calls Python with the interpreter's lock. The first exception is kept for run(); the result is then `failed`.
  template <class F>
  bool ask(F&& function, bool failed = false) {
    const pybind11::gil_scoped_acquire locked;
    if (exception_) return failed;
    try {
      return function();
    } catch (...) {
      exception_ = std::current_exception();
      return failed;
    }
  }

 private:
  bool report(const Progress& now);
  void rethrow();

  pybind11::object progress_;
  std::exception_ptr exception_;
};

}  // namespace ibr::python
