// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ibr/device.h"

namespace ibr {

/// Where the device may draw views together at all: draws a few small squares into a canvas of two layers and looks
/// where they went. There are drivers that claim VK_KHR_multiview and put every view into the first layer (lavapipe of
/// Mesa 22.3.6), so claims are not enough. Submits and waits.
bool multiviewWorks(const Device& device);

}  // namespace ibr
