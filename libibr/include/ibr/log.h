// SPDX-License-Identifier: Apache-2.0
// Callbacks for messages and progress. libibr prints nothing and has no global callback.
#pragma once

#include <cstddef>
#include <functional>
#include <string_view>

namespace ibr {

enum class LogLevel { debug, info, warning, error };

/// Called from any thread that works for the function or object that got the callback, by one thread at a time. Empty:
/// messages are dropped.
using LogCallback = std::function<void(LogLevel, std::string_view message)>;

struct Progress {
  std::string_view stage;  // text for people: "matching cells"
  std::size_t done = 0;
  std::size_t total = 0;  // 0: unknown
};

/// Called on the thread that called the libibr function. Returning false cancels: the function throws Error{cancelled}
/// and leaves no half-written file. Empty: never cancelled.
using ProgressCallback = std::function<bool(const Progress&)>;

}  // namespace ibr
