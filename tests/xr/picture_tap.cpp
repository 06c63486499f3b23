// SPDX-License-Identifier: Apache-2.0
#include "picture_tap.h"

namespace ibr::test {
namespace {

constexpr VkMemoryPropertyFlags kReadable = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;

std::uint32_t readableType(VkPhysicalDevice physical, std::uint32_t allowed) {
  VkPhysicalDeviceMemoryProperties properties;
  vkGetPhysicalDeviceMemoryProperties(physical, &properties);
  for (std::uint32_t i = 0; i < properties.memoryTypeCount; ++i)
    if (allowed >> i & 1 && (properties.memoryTypes[i].propertyFlags & kReadable) == kReadable) return i;
  return 0;
}

void barrier(VkCommandBuffer commands, VkImage image, std::uint32_t layer, VkImageLayout from, VkImageLayout to) {
  VkImageMemoryBarrier b{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};
  b.srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT | VK_ACCESS_MEMORY_READ_BIT;
  b.dstAccessMask = b.srcAccessMask;
  b.oldLayout = from;
  b.newLayout = to;
  b.srcQueueFamilyIndex = b.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  b.image = image;
  b.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, layer, 1};
  vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, nullptr,
                       0, nullptr, 1, &b);
}

void record(VkCommandBuffer commands, VkImage image, std::uint32_t layer, VkRect2D rect, VkBuffer into) {
  VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  vkBeginCommandBuffer(commands, &begin);
  constexpr VkImageLayout kGiven = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
  barrier(commands, image, layer, kGiven, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
  VkBufferImageCopy region{};
  region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, layer, 1};
  region.imageOffset = {rect.offset.x, rect.offset.y, 0};
  region.imageExtent = {rect.extent.width, rect.extent.height, 1};
  vkCmdCopyImageToBuffer(commands, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, into, 1, &region);
  barrier(commands, image, layer, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, kGiven);
  VkMemoryBarrier toHost{VK_STRUCTURE_TYPE_MEMORY_BARRIER};
  toHost.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
  toHost.dstAccessMask = VK_ACCESS_HOST_READ_BIT;
  vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &toHost, 0, nullptr,
                       0, nullptr);
  vkEndCommandBuffer(commands);
}

}  // namespace

PictureTap::PictureTap(VkPhysicalDevice physical, VkDevice device, std::uint32_t family, std::uint32_t queue)
    : physical_(physical), device_(device), family_(family) {
  vkGetDeviceQueue(device, family, queue, &queue_);
}

bool PictureTap::copy(VkImage image, std::uint32_t layer, VkRect2D rect, VkBuffer into) const {
  VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
  pool.queueFamilyIndex = family_;
  VkCommandPool commandPool = VK_NULL_HANDLE;
  if (vkCreateCommandPool(device_, &pool, nullptr, &commandPool) != VK_SUCCESS) return false;
  VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
  allocate.commandPool = commandPool;
  allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  allocate.commandBufferCount = 1;
  VkCommandBuffer commands = VK_NULL_HANDLE;
  bool done = vkAllocateCommandBuffers(device_, &allocate, &commands) == VK_SUCCESS;
  if (done) {
    record(commands, image, layer, rect, into);
    VkSubmitInfo submit{VK_STRUCTURE_TYPE_SUBMIT_INFO};
    submit.commandBufferCount = 1;
    submit.pCommandBuffers = &commands;
    done = vkQueueSubmit(queue_, 1, &submit, VK_NULL_HANDLE) == VK_SUCCESS && vkQueueWaitIdle(queue_) == VK_SUCCESS;
  }
  vkDestroyCommandPool(device_, commandPool, nullptr);
  return done;
}

std::vector<std::uint8_t> PictureTap::read(VkImage image, std::uint32_t layer, VkRect2D rect) const {
  if (!device_) return {};
  std::vector<std::uint8_t> pixels(std::size_t(rect.extent.width) * rect.extent.height * 4);
  VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
  info.size = pixels.size();
  info.usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  VkBuffer buffer = VK_NULL_HANDLE;
  if (vkCreateBuffer(device_, &info, nullptr, &buffer) != VK_SUCCESS) return {};
  VkMemoryRequirements needs;
  vkGetBufferMemoryRequirements(device_, buffer, &needs);
  VkMemoryAllocateInfo allocate{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
  allocate.allocationSize = needs.size;
  allocate.memoryTypeIndex = readableType(physical_, needs.memoryTypeBits);
  VkDeviceMemory memory = VK_NULL_HANDLE;
  void* mapped = nullptr;
  const bool done = vkAllocateMemory(device_, &allocate, nullptr, &memory) == VK_SUCCESS &&
                    vkBindBufferMemory(device_, buffer, memory, 0) == VK_SUCCESS && copy(image, layer, rect, buffer) &&
                    vkMapMemory(device_, memory, 0, VK_WHOLE_SIZE, 0, &mapped) == VK_SUCCESS;
  if (done)
    pixels.assign(static_cast<const std::uint8_t*>(mapped), static_cast<const std::uint8_t*>(mapped) + pixels.size());
  vkDestroyBuffer(device_, buffer, nullptr);
  vkFreeMemory(device_, memory, nullptr);
  return done ? pixels : std::vector<std::uint8_t>{};
}

}  // namespace ibr::test
