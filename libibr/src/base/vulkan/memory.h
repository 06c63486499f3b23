// SPDX-License-Identifier: Apache-2.0
// Device memory: one allocation per buffer or image. Cells share buffers and photographs share texture arrays, so a
// scene needs few allocations.
#pragma once

#include <vulkan/vulkan_core.h>

#include <string_view>

#include "base/vulkan/handle.h"
#include "ibr/device.h"

namespace ibr {

enum class MemoryKind {
  device,    // fast for the device; not mapped
  upload,    // written by the host; mapped, coherent
  readback,  // read by the host; mapped, coherent, cached if the device has such memory
};

/// Throws Error{outOfMemory} with the resource and its size; sizes beyond the heap fail without a call to Vulkan.
MemoryHandle allocate(const Device& device, const VkMemoryRequirements& requirements, MemoryKind kind,
                      std::string_view name);

}  // namespace ibr
