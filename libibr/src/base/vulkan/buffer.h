// SPDX-License-Identifier: Apache-2.0
// A buffer with its memory.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstddef>
#include <span>
#include <string_view>

#include "base/vulkan/handle.h"
#include "base/vulkan/memory.h"
#include "ibr/device.h"

namespace ibr {

/// Move-only; the device must outlive the buffer. Empty when default-made; a moved-from buffer only allows assignment.
class Buffer {
 public:
  Buffer() = default;
  /// `size` is at least 1. Throws Error{outOfMemory} with the buffer's name and size.
  Buffer(const Device& device, VkDeviceSize size, VkBufferUsageFlags usage, MemoryKind kind, std::string_view name);

  VkBuffer get() const noexcept { return buffer_.get(); }
  VkDeviceSize size() const noexcept { return size_; }

  /// upload, readback: the whole buffer, valid while the buffer lives. Host-coherent, so no flush is needed, but
  /// commands that write the buffer must end with a barrier to use::kHostRead. device: empty.
  std::span<std::byte> mapped() const noexcept { return mapped_; }

  VkDeviceSize allocatedBytes() const noexcept { return allocated_; }

 private:
  Allocation memory_;  // before the buffer: destroyed after it
  BufferHandle buffer_;
  VkDeviceSize size_ = 0;
  VkDeviceSize allocated_ = 0;
  std::span<std::byte> mapped_;
};

}  // namespace ibr
