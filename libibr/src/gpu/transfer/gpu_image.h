// SPDX-License-Identifier: Apache-2.0
// An image with its memory and a view of the whole of it.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <string_view>

#include "gpu/device/handle.h"
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

/// Move-only; the device must outlive it. Begins as use::kUndefined. Optimal tiling, one sample, one queue family.
class GpuImage {
 public:
  GpuImage() = default;
  /// Throws Error{unsupported} where the device has no such images (format with usage, extent, layers), naming what is
  /// too much, and Error{outOfMemory} that names image and size.
  GpuImage(const Device& device, const GpuImageInfo& info, std::string_view name);

  VkImage get() const noexcept { return image_.get(); }
  VkImageView view() const noexcept { return view_.get(); }  // all layers and levels; none where usage is transfer only
  const GpuImageInfo& info() const noexcept { return info_; }
  VkDeviceSize allocatedBytes() const noexcept { return allocated_; }

 private:
  GpuImageInfo info_;
  MemoryHandle memory_;  // view, image, memory: the order in which they go
  ImageHandle image_;
  ImageViewHandle view_;
  VkDeviceSize allocated_ = 0;
};

/// What such an image would allocate, asked of the device without allocating. Throws as the constructor, but for lack
/// of memory.
VkDeviceSize allocationBytes(const Device& device, const GpuImageInfo& info, std::string_view name);

/// One layer of it, all levels.
ImageViewHandle makeLayerView(const Device& device, const GpuImage& image, std::uint32_t layer);

}  // namespace ibr
