// SPDX-License-Identifier: Apache-2.0
// Device memory: one allocation a resource. What must be many (cells, photographs) shares few resources.
#pragma once

#include <vulkan/vulkan_core.h>

#include <string_view>

#include "gpu/device/handle.h"
#include "ibr/device.h"

namespace ibr {

enum class MemoryKind {
  device,    // fast for the device; not mapped
  upload,    // written by the host; mapped, coherent
  readback,  // read by the host; mapped, coherent, cached where there is such memory
};

/// Throws Error{outOfMemory} that names the resource and its size; what exceeds the heap is not even asked for.
MemoryHandle allocate(const Device& device, const VkMemoryRequirements& requirements, MemoryKind kind,
                      std::string_view name);

}  // namespace ibr
