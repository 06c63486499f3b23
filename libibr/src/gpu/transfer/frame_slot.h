// SPDX-License-Identifier: Apache-2.0
// The commands of a frame that is in flight, and when the device has done them.
#pragma once

#include <vulkan/vulkan_core.h>

#include "gpu/device/handle.h"
#include "ibr/device.h"

namespace ibr {

struct FrameSlot {
  CommandPoolHandle pool;
  VkCommandBuffer commands = VK_NULL_HANDLE;  // the pool's
  FenceHandle done;                           // signalled to begin with
};

/// Throws as vk().
FrameSlot makeFrameSlot(const Device& device);

/// Begins the commands anew, which the device has done. Throws as vk().
void beginCommands(const Device& device, const FrameSlot& slot);

}  // namespace ibr
