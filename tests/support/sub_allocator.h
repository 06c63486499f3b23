// SPDX-License-Identifier: Apache-2.0
// A small sub-allocator, like that of an engine: one VkDeviceMemory holds many blocks.
#pragma once

#include <cstdint>
#include <list>
#include <map>
#include <mutex>
#include <optional>

#include "ibr/device_memory.h"

namespace ibr::test {

/// First fit. Buffers and images lie in different memory, which satisfies bufferImageGranularity. Memory without a
/// block is freed at once. Thread-safe.
class SubAllocator : public DeviceAllocator {
 public:
  /// Larger requests get memory of their own.
  explicit SubAllocator(VkDeviceSize memoryBytes = VkDeviceSize(16) << 20) : memoryBytes_(memoryBytes) {}

  MemoryBlock allocate(const MemoryRequest& request) override;
  void free(const MemoryBlock& block) noexcept override;

  std::size_t blockCount() const { return ranges_.size(); }
  std::size_t memoryCount() const { return memories_.size(); }
  int requests() const { return requests_; }              // calls of allocate()
  int vulkanAllocations() const { return allocations_; }  // calls of vkAllocateMemory

  bool isFull = false;  // allocate() returns no memory

 private:
  struct Memory {
    VkDevice device = VK_NULL_HANDLE;
    VkDeviceMemory handle = VK_NULL_HANDLE;
    std::uint32_t type = 0;
    ResourceTiling tiling = ResourceTiling::linear;
    VkDeviceSize size = 0;
    std::byte* mapped = nullptr;
    std::map<VkDeviceSize, VkDeviceSize> used = {};  // first byte and byte after the last
  };
  struct Range {
    std::list<Memory>::iterator memory;
    VkDeviceSize first;
  };

  static std::optional<VkDeviceSize> place(const Memory& memory, VkDeviceSize size, VkDeviceSize alignment);
  bool addMemory(const MemoryRequest& request, std::uint32_t type);

  VkDeviceSize memoryBytes_;
  std::mutex mutex_;
  std::list<Memory> memories_;
  std::map<std::uintptr_t, Range> ranges_;  // by MemoryBlock::handle
  std::uintptr_t lastHandle_ = 0;
  int requests_ = 0, allocations_ = 0;
};

}  // namespace ibr::test
