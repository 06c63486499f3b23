// SPDX-License-Identifier: Apache-2.0
// Factories of the kinds of ItemOnDevice, for uploadItem.
#pragma once

#include "viewer/open/item_on_device.h"

namespace ibr::app {

std::unique_ptr<ItemOnDevice> sceneOnDevice(Device& device, OpenItem& item, const GpuSceneOptions& options);
std::unique_ptr<ItemOnDevice> modelOnDevice(Device& device, OpenItem& item);

}  // namespace ibr::app
