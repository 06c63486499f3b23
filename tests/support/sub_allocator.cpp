// SPDX-License-Identifier: Apache-2.0
#include "support/sub_allocator.h"

#include <algorithm>

#include "base/vulkan/functions.h"
#include "ibr/device.h"

namespace ibr::test {
namespace {

VkMemoryPropertyFlags flagsOf(const MemoryRequest& request, std::uint32_t type) {
  return request.device.memoryProperties().memoryTypes[type].propertyFlags;
}

// Returns the first type with all preferred flags, or the first one.
std::uint32_t typeFor(const MemoryRequest& request) {
  std::optional<std::uint32_t> first;
  for (std::uint32_t type = 0; type < VK_MAX_MEMORY_TYPES; ++type) {
    if (!(request.requirements.memoryTypeBits >> type & 1)) continue;
    if ((flagsOf(request, type) & request.preferred) == request.preferred) return type;
    if (!first) first = type;
  }
  return first.value_or(0);
}

}  // namespace

MemoryBlock SubAllocator::allocate(const MemoryRequest& request) {
  const std::lock_guard lock(mutex_);
  ++requests_;
  const VkDeviceSize size = request.requirements.size, alignment = request.requirements.alignment;
  const std::uint32_t type = typeFor(request);
  if (isFull) return {};
  const auto blockIn = [&](std::list<Memory>::iterator memory) -> std::optional<MemoryBlock> {
    if (memory->type != type || memory->tiling != request.tiling) return std::nullopt;
    const std::optional<VkDeviceSize> first = place(*memory, size, alignment);
    if (!first) return std::nullopt;
    memory->used[*first] = *first + size;
    ranges_[++lastHandle_] = {memory, *first};
    return MemoryBlock{.memory = memory->handle,
                       .offset = *first,
                       .size = size,
                       .mapped = memory->mapped ? memory->mapped + *first : nullptr,
                       .handle = reinterpret_cast<void*>(lastHandle_)};
  };
  for (auto memory = memories_.begin(); memory != memories_.end(); ++memory)
    if (const auto block = blockIn(memory)) return *block;
  if (!addMemory(request, type)) return {};
  return blockIn(std::prev(memories_.end())).value_or(MemoryBlock{});
}

void SubAllocator::free(const MemoryBlock& block) noexcept {
  const std::lock_guard lock(mutex_);
  const auto found = ranges_.find(reinterpret_cast<std::uintptr_t>(block.handle));
  const auto [memory, first] = found->second;
  ranges_.erase(found);
  memory->used.erase(first);
  if (!memory->used.empty()) return;
  vkFreeMemory(memory->device, memory->handle, nullptr);
  memories_.erase(memory);
}

std::optional<VkDeviceSize> SubAllocator::place(const Memory& memory, VkDeviceSize size, VkDeviceSize alignment) {
  VkDeviceSize first = 0;
  for (const auto& [begin, end] : memory.used) {
    if (first + size <= begin) return first;
    first = (end + alignment - 1) / alignment * alignment;
  }
  return first + size <= memory.size ? std::optional(first) : std::nullopt;
}

bool SubAllocator::addMemory(const MemoryRequest& request, std::uint32_t type) {
  Memory memory{.device = request.device.handle(),
                .type = type,
                .tiling = request.tiling,
                .size = std::max(memoryBytes_, request.requirements.size)};
  const VkMemoryAllocateInfo info{
      .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = memory.size, .memoryTypeIndex = type};
  if (vkAllocateMemory(memory.device, &info, nullptr, &memory.handle) != VK_SUCCESS) return false;
  ++allocations_;
  void* mapped = nullptr;
  if (flagsOf(request, type) & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT)
    vkMapMemory(memory.device, memory.handle, 0, VK_WHOLE_SIZE, 0, &mapped);
  memory.mapped = static_cast<std::byte*>(mapped);
  memories_.push_back(std::move(memory));
  return true;
}

}  // namespace ibr::test
