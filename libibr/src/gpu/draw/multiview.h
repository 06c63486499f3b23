// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ibr/device.h"

namespace ibr {

/// Tests if the device's multiview works: draws small squares into a canvas of two layers and checks their positions.
/// Some drivers claim VK_KHR_multiview and put every view into the first layer (lavapipe of Mesa 22.3.6). Submits and
/// waits.
bool runMultiviewProbe(const Device& device);

/// As runMultiviewProbe(), which only the first successful call for a Device runs.
bool multiviewWorks(const Device& device);

/// The answer of an earlier multiviewWorks(); false without one. Submits nothing.
bool multiviewIsKnownToWork(const Device& device) noexcept;

}  // namespace ibr
