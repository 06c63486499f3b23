// SPDX-License-Identifier: Apache-2.0
// Messages and progress go to callbacks of the caller; libibr prints nothing and keeps no global state.
#pragma once

#include <cstddef>
#include <functional>
#include <string_view>

namespace ibr {

enum class LogLevel { debug, info, warning, error };

/// May be called from any thread that works for the call it was given to, one call at a time. Empty: messages are
/// dropped.
using LogCallback = std::function<void(LogLevel, std::string_view message)>;

struct Progress {
  std::string_view stage;  // what is being done, for people: "matching cells"
  std::size_t done = 0;
  std::size_t total = 0;  // 0 where it is not known
};

/// Called from the thread that made the call. Return false to cancel: the call throws Error{cancelled} and leaves
/// nothing half-written. Empty: never cancelled.
using ProgressCallback = std::function<bool(const Progress&)>;

}  // namespace ibr
