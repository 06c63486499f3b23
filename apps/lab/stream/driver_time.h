// SPDX-License-Identifier: Apache-2.0
// CPU time that a thread spends in the Vulkan driver.
#pragma once

namespace ibr::app {

/// Makes libibr measure its Vulkan calls. Call before the first device is created.
void measureDriverTime();

/// Part of threadSeconds() (base/usage.h) that the calling thread has spent in Vulkan calls and in measuring them, s;
/// 0 before measureDriverTime(), which finds out what the measurement of a call costs.
double driverSeconds();

}  // namespace ibr::app
