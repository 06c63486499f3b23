// SPDX-License-Identifier: Apache-2.0
#include "base/vulkan/gpu_image.h"

#include <algorithm>
#include <cassert>

#include "base/check.h"
#include "base/vulkan/debug.h"
#include "base/vulkan/format.h"
#include "base/vulkan/functions.h"

namespace ibr {
namespace {

std::uint64_t minBytes(const GpuImageInfo& info) {
  std::uint64_t blocks = 0;
  for (std::uint32_t level = 0; level < info.mipLevels; ++level)
    blocks += std::uint64_t(blockCount(info.format, std::max(1u, info.extent.width >> level))) *
              blockCount(info.format, std::max(1u, info.extent.height >> level));
  return blocks * info.layers * blockBytes(info.format);
}

void checkSupport(const Device& device, const GpuImageInfo& info, std::string_view name) {
  VkImageFormatProperties can{};
  const VkResult result = vkGetPhysicalDeviceImageFormatProperties(
      device.physicalDevice(), info.format, VK_IMAGE_TYPE_2D, VK_IMAGE_TILING_OPTIMAL, info.usage, 0, &can);
  check(result != VK_ERROR_FORMAT_NOT_SUPPORTED, ErrorCode::unsupported,
        "{}: {} does not support images of VkFormat {} with VkImageUsageFlags {:#x}", name, device.name(),
        int(info.format), info.usage);
  vk(result, "vkGetPhysicalDeviceImageFormatProperties");
  const auto checkLimit = [&](const char* what, std::uint32_t value, std::uint32_t limit) {
    check(value <= limit, ErrorCode::unsupported, "{}: {} {}, but the maximum is {} on {}", name, what, value, limit,
          device.name());
  };
  checkLimit("width", info.extent.width, can.maxExtent.width);
  checkLimit("height", info.extent.height, can.maxExtent.height);
  checkLimit("layers", info.layers, can.maxArrayLayers);
  checkLimit("mip levels", info.mipLevels, can.maxMipLevels);
  const std::uint64_t bytes = minBytes(info);
  check(bytes <= can.maxResourceSize, ErrorCode::outOfMemory,
        "{}: {} bytes exceed the maximum image size of {} bytes on {}", name, bytes, can.maxResourceSize,
        device.name());
}

ImageHandle makeImage(const Device& device, const GpuImageInfo& info, std::string_view name) {
  assert(info.extent.width > 0 && info.extent.height > 0 && info.layers > 0 && info.mipLevels > 0);
  checkSupport(device, info, name);
  const VkImageCreateInfo imageInfo{.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                    .imageType = VK_IMAGE_TYPE_2D,
                                    .format = info.format,
                                    .extent = {info.extent.width, info.extent.height, 1},
                                    .mipLevels = info.mipLevels,
                                    .arrayLayers = info.layers,
                                    .samples = VK_SAMPLE_COUNT_1_BIT,
                                    .tiling = VK_IMAGE_TILING_OPTIMAL,
                                    .usage = info.usage};
  return make<ImageHandle>(device, vkCreateImage, imageInfo, "vkCreateImage");
}

VkMemoryRequirements requirementsOf(const Device& device, VkImage image) {
  VkMemoryRequirements requirements;
  vkGetImageMemoryRequirements(device.handle(), image, &requirements);
  return requirements;
}

}  // namespace

GpuImage::GpuImage(const Device& device, const GpuImageInfo& info, std::string_view name)
    : info_(info), image_(makeImage(device, info, name)) {
  nameObject(device, VK_OBJECT_TYPE_IMAGE, image_.get(), name);

  const VkMemoryRequirements requirements = requirementsOf(device, image_.get());
  memory_ = Allocation(device, requirements, MemoryKind::device, ResourceTiling::optimal, name);
  allocated_ = requirements.size;
  vk(vkBindImageMemory(device.handle(), image_.get(), memory_.memory(), memory_.offset()), "vkBindImageMemory");

  constexpr VkImageUsageFlags kTransfers = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  if (!(info.usage & ~kTransfers)) return;
  const VkImageViewCreateInfo viewInfo{
      .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
      .image = image_.get(),
      .viewType = info.viewType,
      .format = info.format,
      .subresourceRange = {info.aspect, 0, VK_REMAINING_MIP_LEVELS, 0, VK_REMAINING_ARRAY_LAYERS}};
  view_ = make<ImageViewHandle>(device, vkCreateImageView, viewInfo, "vkCreateImageView");
  nameObject(device, VK_OBJECT_TYPE_IMAGE_VIEW, view_.get(), name);
}

VkDeviceSize allocationBytes(const Device& device, const GpuImageInfo& info, std::string_view name) {
  const ImageHandle image = makeImage(device, info, name);
  return requirementsOf(device, image.get()).size;
}

ImageViewHandle makeLayerView(const Device& device, const GpuImage& image, std::uint32_t layer) {
  const VkImageViewCreateInfo info{.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                   .image = image.get(),
                                   .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                   .format = image.info().format,
                                   .subresourceRange = {image.info().aspect, 0, image.info().mipLevels, layer, 1}};
  return make<ImageViewHandle>(device, vkCreateImageView, info, "vkCreateImageView");
}

}  // namespace ibr
