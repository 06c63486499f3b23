// SPDX-License-Identifier: Apache-2.0
// How fast this machine matches photographs at present, found by doing a little of it.
#pragma once

#include "author/build/build_cost.h"

namespace ibr {

/// Matches a small generated pair again and again for a few tenths of a second, on as many threads as the work will
/// have. Other programs that run beside it count, as they will during the work. Precondition: OpenCV has one thread.
MachineSpeed measureSpeed(int threads);

}  // namespace ibr
