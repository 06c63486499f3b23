// SPDX-License-Identifier: Apache-2.0
// Checks of user input: a failed check throws Error with the values in the message. Programmer errors are asserts.
#pragma once

#include <fmt/format.h>

#include <utility>

#include "ibr/error.h"

namespace ibr {

/// Throws Error{code} with the formatted message. Numbers print the same in every locale.
template <class... Args>
[[noreturn]] void fail(ErrorCode code, fmt::format_string<Args...> format, Args&&... args) {
  throw Error(code, fmt::format(format, std::forward<Args>(args)...));
}

template <class... Args>
void check(bool holds, ErrorCode code, fmt::format_string<Args...> format, Args&&... args) {
  if (!holds) fail(code, format, std::forward<Args>(args)...);
}

}  // namespace ibr
