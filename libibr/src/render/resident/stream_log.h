// SPDX-License-Identifier: Apache-2.0
// Messages of a GpuScene.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <utility>

#include "ibr/log.h"

namespace ibr {

template <class... Arguments>
void say(const LogCallback& log, LogLevel level, fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  if (log) log(level, fmt::format(format, std::forward<Arguments>(arguments)...));
}

inline double megabytes(std::uint64_t bytes) {
  return double(bytes) / 1e6;
}

}  // namespace ibr
