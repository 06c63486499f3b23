// SPDX-License-Identifier: Apache-2.0
#include "base/vulkan/buffer.h"

#include <cassert>

#include "base/check.h"
#include "base/vulkan/debug.h"
#include "base/vulkan/functions.h"

namespace ibr {
namespace {

VkDeviceSize largestBuffer(const Device& device) {
  VkPhysicalDeviceVulkan13Properties properties13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_PROPERTIES};
  VkPhysicalDeviceProperties2 properties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2,
                                         .pNext = &properties13};
  vkGetPhysicalDeviceProperties2(device.physicalDevice(), &properties);
  return properties13.maxBufferSize;
}

}  // namespace

Buffer::Buffer(const Device& device, VkDeviceSize size, VkBufferUsageFlags usage, MemoryKind kind,
               std::string_view name)
    : size_(size) {
  assert(size > 0);
  const VkDeviceSize largest = largestBuffer(device);
  check(size <= largest, ErrorCode::outOfMemory, "{}: {} bytes exceed the maximum buffer size of {} bytes on {}", name,
        size, largest, device.name());
  const VkBufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = size, .usage = usage};
  buffer_ = make<BufferHandle>(device, vkCreateBuffer, info, "vkCreateBuffer");
  nameObject(device, VK_OBJECT_TYPE_BUFFER, buffer_.get(), name);

  VkMemoryRequirements requirements;
  vkGetBufferMemoryRequirements(device.handle(), buffer_.get(), &requirements);
  memory_ = Allocation(device, requirements, kind, ResourceTiling::linear, name);
  allocated_ = requirements.size;
  vk(vkBindBufferMemory(device.handle(), buffer_.get(), memory_.memory(), memory_.offset()), "vkBindBufferMemory");
  if (kind != MemoryKind::device) mapped_ = {memory_.mapped(), size};
}

}  // namespace ibr
