// SPDX-License-Identifier: Apache-2.0
// Callbacks for messages and progress. libibr prints nothing and has no global callback.
#pragma once

#include <cstddef>
#include <functional>
#include <string_view>

namespace ibr {

/// Severity of a message.
enum class LogLevel {
  debug,    // details for developers
  info,     // choices and results
  warning,  // reduced quality, or input that was left out
  error     // a failure that does not end the call
};

/// Gets messages. Called from any thread that works for the function or object that got the callback, by one thread at
/// a time. Empty: messages are dropped.
using LogCallback = std::function<void(LogLevel, std::string_view message)>;

/// Progress of a call.
struct Progress {
  std::string_view stage;  // name of the stage, for people: "matching cells"
  std::size_t done = 0;    // finished items of the stage
  std::size_t total = 0;   // all items of the stage; 0: unknown
};

/// Gets progress. Called on the thread that called the libibr function. Returning false cancels: the function throws
/// Error{cancelled} and leaves no half-written file. Empty: never cancelled.
using ProgressCallback = std::function<bool(const Progress&)>;

}  // namespace ibr
