// SPDX-License-Identifier: Apache-2.0
// Device memory of one buffer or image, from the device's allocator or from vkAllocateMemory. Cells share buffers and
// photographs share texture arrays, so a scene needs few allocations.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstddef>
#include <string_view>

#include "ibr/device.h"
#include "ibr/device_memory.h"

namespace ibr {

/// Move-only; device and allocator must outlive it. A default-made or moved-from allocation has no memory.
class Allocation {
 public:
  Allocation() = default;
  /// Throws Error{outOfMemory} with the resource and its size, Error (unsupported, invalidInput) with the resource.
  /// Sizes beyond the memory heaps fail without a call to the allocator or to Vulkan.
  Allocation(const Device& device, const VkMemoryRequirements& requirements, MemoryKind kind, ResourceTiling tiling,
             std::string_view name);
  Allocation(Allocation&& other) noexcept;
  Allocation& operator=(Allocation&& other) noexcept;
  ~Allocation() { reset(); }

  VkDeviceMemory memory() const noexcept { return block_.memory; }
  VkDeviceSize offset() const noexcept { return block_.offset; }  // to bind the resource at, bytes
  std::byte* mapped() const noexcept { return block_.mapped; }    // upload, readback: the first byte

 private:
  Allocation(VkDevice device, DeviceAllocator* allocator) noexcept : device_(device), allocator_(allocator) {}
  void allocateOwn(const MemoryRequest& request);
  void allocateFrom(const MemoryRequest& request);
  void reset() noexcept;

  VkDevice device_ = VK_NULL_HANDLE;
  DeviceAllocator* allocator_ = nullptr;  // null: the memory is this allocation's own
  MemoryBlock block_;
};

}  // namespace ibr
