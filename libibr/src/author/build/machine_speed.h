// SPDX-License-Identifier: Apache-2.0
// Measures the present speed of this machine by matching a small sample.
#pragma once

#include "author/build/build_cost.h"

namespace ibr {

/// Matches a small generated pair repeatedly for a few tenths of a second, on `threads` threads. The load of other
/// programs counts, since it will slow the build too. Precondition: OpenCV has one thread.
MachineSpeed measureSpeed(int threads);

}  // namespace ibr
