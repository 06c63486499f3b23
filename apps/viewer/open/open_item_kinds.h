// SPDX-License-Identifier: Apache-2.0
// Factories of the kinds of PlaceOnDevice, for putOnDevice.
#pragma once

#include "viewer/open/place_on_device.h"

namespace ibr::app {

std::unique_ptr<PlaceOnDevice> sceneOnDevice(Device& device, OpenItem& place, const GpuSceneOptions& options);
std::unique_ptr<PlaceOnDevice> modelOnDevice(Device& device, OpenItem& place);

}  // namespace ibr::app
