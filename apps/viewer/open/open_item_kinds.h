// SPDX-License-Identifier: Apache-2.0
// The kinds of place, for putOnDevice.
#pragma once

#include "viewer/open/place_on_device.h"

namespace ibr::app {

std::unique_ptr<PlaceOnDevice> sceneOnDevice(Device& device, OpenItem& place, const GpuSceneOptions& options);
std::unique_ptr<PlaceOnDevice> modelOnDevice(Device& device, OpenItem& place);

}  // namespace ibr::app
