// SPDX-License-Identifier: Apache-2.0
#include "base/vulkan/memory.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <utility>

#include "base/check.h"
#include "base/vulkan/debug.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/vulkan.h"

namespace ibr {
namespace {

void setFlags(MemoryRequest& request) {
  constexpr VkMemoryPropertyFlags kMapped = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  switch (request.kind) {
    case MemoryKind::upload:
      request.required = kMapped;
      request.avoided = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT | VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
      break;
    case MemoryKind::readback:
      request.required = kMapped;
      request.preferred = VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
      request.avoided = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
      break;
    case MemoryKind::device:
      // Host-visible memory of a discrete GPU is often a small window, best left to other uses.
      request.preferred = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
      request.avoided = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT;
      break;
  }
}

std::uint32_t usableTypes(const VkPhysicalDeviceMemoryProperties& memory, std::uint32_t allowed,
                          VkMemoryPropertyFlags required) {
  // Protected, lazily allocated and vendor-specific memory needs features or usages that libibr does not enable.
  constexpr VkMemoryPropertyFlags kOrdinary = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT |
                                              VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
                                              VK_MEMORY_PROPERTY_HOST_COHERENT_BIT | VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
  std::uint32_t usable = 0;
  for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
    const VkMemoryPropertyFlags flags = memory.memoryTypes[i].propertyFlags;
    if ((allowed >> i & 1) && (flags & required) == required && !(flags & ~kOrdinary)) usable |= 1u << i;
  }
  return usable;
}

// Returns the best of the request's types, the first among equals as Vulkan orders them by speed.
std::uint32_t bestType(const VkPhysicalDeviceMemoryProperties& memory, const MemoryRequest& request) {
  std::uint32_t best = 0;
  int bestScore = std::numeric_limits<int>::min();
  for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
    const VkMemoryPropertyFlags flags = memory.memoryTypes[i].propertyFlags;
    const int score = 4 * std::popcount(flags & request.preferred) - std::popcount(flags & request.avoided);
    if (!(request.requirements.memoryTypeBits >> i & 1) || score <= bestScore) continue;
    best = i;
    bestScore = score;
  }
  return best;
}

void checkHeaps(const MemoryRequest& request, std::uint32_t types) {
  const VkPhysicalDeviceMemoryProperties& memory = request.device.memoryProperties();
  VkDeviceSize heap = 0;  // the largest
  for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i)
    if (types >> i & 1) heap = std::max(heap, memory.memoryHeaps[memory.memoryTypes[i].heapIndex].size);
  check(request.requirements.size <= heap, ErrorCode::outOfMemory,
        "{}: {} bytes exceed the {} bytes of the memory heap on {}", request.name, request.requirements.size, heap,
        request.device.name());
}

}  // namespace

Allocation::Allocation(const Device& device, const VkMemoryRequirements& requirements, MemoryKind kind,
                       ResourceTiling tiling, std::string_view name)
    : Allocation(device.handle(), device.allocator()) {
  checkAlive(device, "vkAllocateMemory");
  MemoryRequest request{.device = device, .name = name, .requirements = requirements, .kind = kind, .tiling = tiling};
  setFlags(request);
  std::uint32_t& types = request.requirements.memoryTypeBits;
  types = usableTypes(device.memoryProperties(), types, request.required);
  check(types != 0, ErrorCode::unsupported, "{}: {} has no suitable memory type", name, device.name());
  if (allocator_)
    allocateFrom(request);
  else
    allocateOwn(request);
}

void Allocation::allocateFrom(const MemoryRequest& request) {
  const auto& [size, alignment, types] = request.requirements;
  checkHeaps(request, types);
  block_ = allocator_->allocate(request);
  check(block_.memory != VK_NULL_HANDLE, ErrorCode::outOfMemory, "{}: the allocator has no memory for {} bytes on {}",
        request.name, size, request.device.name());
  check(block_.offset % alignment == 0, ErrorCode::invalidInput,
        "{}: the allocator's block has offset {}, not a multiple of {}", request.name, block_.offset, alignment);
  check(block_.size >= size, ErrorCode::invalidInput, "{}: the allocator's block has {} bytes, not {}", request.name,
        block_.size, size);
  check(request.kind == MemoryKind::device || block_.mapped, ErrorCode::invalidInput,
        "{}: the allocator's block of {} bytes is not mapped", request.name, size);
}

void Allocation::allocateOwn(const MemoryRequest& request) {
  const Device& device = request.device;
  const VkDeviceSize size = request.requirements.size;
  const std::uint32_t type = bestType(device.memoryProperties(), request);
  checkHeaps(request, 1u << type);
  const VkMemoryAllocateInfo info{
      .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = size, .memoryTypeIndex = type};
  VkDeviceMemory memory = VK_NULL_HANDLE;
  const VkResult result = vkAllocateMemory(device_, &info, nullptr, &memory);
  check(result != VK_ERROR_OUT_OF_DEVICE_MEMORY && result != VK_ERROR_OUT_OF_HOST_MEMORY, ErrorCode::outOfMemory,
        "{}: cannot allocate {} bytes on {} (vkAllocateMemory: {})", request.name, size, device.name(),
        resultName(result));
  vk(device, result, "vkAllocateMemory");
  block_ = {.memory = memory, .size = size};
  nameObject(device, VK_OBJECT_TYPE_DEVICE_MEMORY, memory, request.name);
  if (request.kind == MemoryKind::device) return;
  void* data = nullptr;
  vk(vkMapMemory(device_, memory, 0, VK_WHOLE_SIZE, 0, &data), "vkMapMemory");
  block_.mapped = static_cast<std::byte*>(data);
}

Allocation::Allocation(Allocation&& other) noexcept
    : device_(other.device_), allocator_(other.allocator_), block_(std::exchange(other.block_, {})) {}

Allocation& Allocation::operator=(Allocation&& other) noexcept {
  if (this == &other) return *this;
  reset();
  device_ = other.device_;
  allocator_ = other.allocator_;
  block_ = std::exchange(other.block_, {});
  return *this;
}

void Allocation::reset() noexcept {
  const MemoryBlock block = std::exchange(block_, {});
  if (block.memory == VK_NULL_HANDLE) return;
  if (allocator_)
    allocator_->free(block);
  else
    vkFreeMemory(device_, block.memory, nullptr);
}

}  // namespace ibr
