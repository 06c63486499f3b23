// SPDX-License-Identifier: Apache-2.0
// Device memory of libibr's buffers and images from the caller's allocator: DeviceOptions::allocator or
// DeviceHandles::allocator. Without an allocator, each resource has its own vkAllocateMemory. libibr needs few
// resources: cells share buffers, photographs share texture arrays.
//
// Threading: libibr calls an allocator from the threads that make, stream and destroy objects of its device, from
// the thread that clears, assigns or destroys Uploads (ibr/uploads.h), and from the reader threads or the executor of a
// GpuScene that streams photographs (ibr/gpu_scene.h). Where these are several threads, also with a Device each, the
// allocator must be thread-safe.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "ibr/export.h"

namespace ibr {

class Device;

/// Access to a memory block by host and device.
enum class MemoryKind : std::uint8_t {
  device,    // fast for the device; not mapped
  upload,    // written by the host; mapped, coherent
  readback,  // read by the host; mapped, coherent, cached if the device has such memory
};

/// Sort of resource that a memory block is for.
enum class ResourceTiling : std::uint8_t {
  linear,   // a buffer
  optimal,  // an image. In one VkDeviceMemory, keep VkPhysicalDeviceLimits::bufferImageGranularity between both sorts
};

/// Request for the memory of one buffer or image. `device` and `name` are valid during the call.
struct MemoryRequest {
  const Device& device;   // device that the memory is for
  std::string_view name;  // name of the resource, for people; several resources may have one name
  /// Size and alignment in bytes. memoryTypeBits are the types to choose from: all have the flags `required`; none is
  /// protected, lazily allocated or vendor-specific. Neither size nor memoryTypeBits is 0.
  VkMemoryRequirements requirements{};
  MemoryKind kind = MemoryKind::device;            // access by host and device
  ResourceTiling tiling = ResourceTiling::linear;  // buffer or image
  VkMemoryPropertyFlags required = 0;  // all of the memory type; host-visible and coherent for upload and readback
  VkMemoryPropertyFlags preferred = 0, avoided = 0;  // hints for the choice of the memory type
};

/// Range of a VkDeviceMemory for one resource.
struct MemoryBlock {
  VkDeviceMemory memory = VK_NULL_HANDLE;  // null: out of memory
  VkDeviceSize offset = 0;                 // bytes from the start of `memory`; a multiple of the request's alignment
  VkDeviceSize size = 0;                   // bytes; at least the request's size
  std::byte* mapped = nullptr;  // upload, readback: host address of the block's first byte, valid until free()
  void* handle = nullptr;       // for the allocator alone
};

/// Source of a device's memory. Must outlive the device and all objects made from it. If it keeps VkDeviceMemory that
/// no block uses, it must free this memory before the VkDevice is destroyed; Device::create's device is destroyed by
/// ~Device. An allocator must not make or destroy objects of libibr.
class IBR_API DeviceAllocator {
 public:
  virtual ~DeviceAllocator() = default;  // called by the owner; libibr destroys no allocator

  /// Returns a block of one of the request's memory types. For a block without memory libibr throws Error{outOfMemory}
  /// with the resource's name and size. May itself throw Error and nothing else; libibr's caller gets the Error, except
  /// while photographs are streamed, which lowers the budget after either. libibr throws Error{invalidInput} that names
  /// the resource for a misaligned offset, a size that is too small and a missing mapping; such a block goes to free().
  virtual MemoryBlock allocate(const MemoryRequest& request) = 0;

  /// Takes back a block as allocate() returned it. The device has finished with the resource.
  virtual void free(const MemoryBlock& block) noexcept = 0;
};

}  // namespace ibr
