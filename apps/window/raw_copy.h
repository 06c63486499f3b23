// SPDX-License-Identifier: Apache-2.0
// Copies display-encoded values between images bit by bit, without conversion between UNORM and SRGB.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>

#include "base/vulkan/functions.h"

namespace ibr::app {

/// Returns the UNORM format with the same bits: the format itself if UNORM, its counterpart if SRGB.
/// VK_FORMAT_UNDEFINED for formats that the program does not show pictures in.
constexpr VkFormat rawFormat(VkFormat format) noexcept {
  switch (format) {
    case VK_FORMAT_B8G8R8A8_UNORM:
    case VK_FORMAT_R8G8B8A8_UNORM:
    case VK_FORMAT_A8B8G8R8_UNORM_PACK32:
    case VK_FORMAT_A2B10G10R10_UNORM_PACK32:
    case VK_FORMAT_A2R10G10B10_UNORM_PACK32:
    case VK_FORMAT_R5G6B5_UNORM_PACK16:
      return format;
    case VK_FORMAT_B8G8R8A8_SRGB:
      return VK_FORMAT_B8G8R8A8_UNORM;
    case VK_FORMAT_R8G8B8A8_SRGB:
      return VK_FORMAT_R8G8B8A8_UNORM;
    case VK_FORMAT_A8B8G8R8_SRGB_PACK32:
      return VK_FORMAT_A8B8G8R8_UNORM_PACK32;
    default:
      return VK_FORMAT_UNDEFINED;
  }
}

/// Image, offset and layer of one side of a copy.
struct RawPart {
  VkImage image;
  VkOffset2D corner{0, 0};
  std::uint32_t layer = 0;
};

/// Records a copy between images of the same rawFormat. `from` must be in use::kTransferSource, `to` in
/// use::kTransferDestination; both keep their uses.
inline void recordRawCopy(VkCommandBuffer commands, const RawPart& from, const RawPart& to,
                          VkExtent2D extent) noexcept {
  const VkImageCopy region{{VK_IMAGE_ASPECT_COLOR_BIT, 0, from.layer, 1},
                           {from.corner.x, from.corner.y, 0},
                           {VK_IMAGE_ASPECT_COLOR_BIT, 0, to.layer, 1},
                           {to.corner.x, to.corner.y, 0},
                           {extent.width, extent.height, 1}};
  vkCmdCopyImage(commands, from.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, to.image,
                 VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
}

}  // namespace ibr::app
