// SPDX-License-Identifier: Apache-2.0
// An image with its memory and a view of the whole image.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <string_view>

#include "base/vulkan/handle.h"
#include "base/vulkan/memory.h"
#include "ibr/device.h"

namespace ibr {

struct GpuImageInfo {
  VkFormat format = VK_FORMAT_UNDEFINED;
  VkExtent2D extent{0, 0};
  std::uint32_t layers = 1;
  std::uint32_t mipLevels = 1;
  VkImageUsageFlags usage = 0;
  VkImageAspectFlags aspect = VK_IMAGE_ASPECT_COLOR_BIT;
  VkImageViewType viewType = VK_IMAGE_VIEW_TYPE_2D;  // with more than one layer: VK_IMAGE_VIEW_TYPE_2D_ARRAY
};

/// Move-only; must not outlive the device. Starts in use::kUndefined. Optimal tiling, one sample, one queue family.
class GpuImage {
 public:
  GpuImage() = default;
  /// Throws Error{unsupported} with the exceeded limit if the device lacks such images (format with usage, extent,
  /// layers), and Error{outOfMemory} with the image's name and size.
  GpuImage(const Device& device, const GpuImageInfo& info, std::string_view name);

  VkImage get() const noexcept { return image_.get(); }
  VkImageView view() const noexcept { return view_.get(); }  // all layers and levels; null for transfer-only usage
  const GpuImageInfo& info() const noexcept { return info_; }
  VkDeviceSize allocatedBytes() const noexcept { return allocated_; }

 private:
  GpuImageInfo info_;
  Allocation memory_;  // destroyed in the order view, image, memory
  ImageHandle image_;
  ImageViewHandle view_;
  VkDeviceSize allocated_ = 0;
};

/// Bytes that such an image would allocate; the call allocates nothing. Throws as the constructor, except for lack of
/// memory.
VkDeviceSize allocationBytes(const Device& device, const GpuImageInfo& info, std::string_view name);

/// View of one layer, all levels.
ImageViewHandle makeLayerView(const Device& device, const GpuImage& image, std::uint32_t layer);

}  // namespace ibr
