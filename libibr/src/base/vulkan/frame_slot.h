// SPDX-License-Identifier: Apache-2.0
// Command buffer and fence of a frame in flight.
#pragma once

#include <vulkan/vulkan_core.h>

#include "base/vulkan/handle.h"
#include "ibr/device.h"

namespace ibr {

struct FrameSlot {
  CommandPoolHandle pool;
  VkCommandBuffer commands = VK_NULL_HANDLE;  // allocated from pool
  FenceHandle done;                           // initially signalled
};

/// Throws as vk().
FrameSlot makeFrameSlot(const Device& device);

/// Begins the command buffer again; the device must have finished it. Throws as vk().
void beginCommands(const Device& device, const FrameSlot& slot);

}  // namespace ibr
