// SPDX-License-Identifier: Apache-2.0
// Cancellation of long work by a std::stop_token.
#pragma once

#include <stop_token>

#include "base/check.h"

namespace ibr {

/// Throws Error{cancelled} if a stop was requested. `what`: the work, for the message ("loading the scene").
inline void checkStop(const std::stop_token& stop, const char* what) {
  check(!stop.stop_requested(), ErrorCode::cancelled, "{} was cancelled", what);
}

}  // namespace ibr
