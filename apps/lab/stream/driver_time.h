// SPDX-License-Identifier: Apache-2.0
// CPU time that a thread spends in the Vulkan driver.
#pragma once

namespace ibr::app {

/// Makes libibr measure its Vulkan calls. Call before the first device is created. The measurement of a call costs
/// about half a microsecond, half of which counts as the caller's own time.
void measureDriverTime();

/// Part of threadSeconds() (base/usage.h) that the calling thread has spent in Vulkan calls, s; 0 before
/// measureDriverTime().
double driverSeconds();

}  // namespace ibr::app
