// SPDX-License-Identifier: Apache-2.0
#include "vr/menu/mirror.h"

#include <algorithm>

#include "base/check.h"
#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"
#include "window/raw_copy.h"

namespace ibr::app {
namespace {

constexpr VkImageSubresourceLayers kColour{VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};

GpuImageInfo imageInfo(VkFormat format, VkExtent2D extent) {
  check(rawFormat(format) != VK_FORMAT_UNDEFINED, ErrorCode::unsupported,
        "the mirror window cannot show the headset's images: VkFormat {}", int(format));
  return {.format = rawFormat(format),
          .extent = extent,
          .usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT};
}

void clear(VkCommandBuffer commands, VkImage image) {
  const VkClearColorValue grey{.float32 = {0.11f, 0.12f, 0.13f, 1}};
  const VkImageSubresourceRange all{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  vkCmdClearColorImage(commands, image, use::kTransferDestination.layout, &grey, 1, &all);
}

}  // namespace

VkRect2D letterbox(VkExtent2D picture, VkExtent2D window) noexcept {
  // Products of two sides may exceed 32 bits.
  const auto scaled = [](std::uint32_t side, std::uint32_t numerator, std::uint32_t denominator) {
    return std::max(1u, std::uint32_t((std::uint64_t(side) * numerator + denominator / 2) / denominator));
  };
  VkExtent2D size = window;
  if (std::uint64_t(picture.width) * window.height > std::uint64_t(window.width) * picture.height)
    size.height = std::min(window.height, scaled(picture.height, window.width, picture.width));
  else
    size.width = std::min(window.width, scaled(picture.width, window.height, picture.height));
  return {{std::int32_t((window.width - size.width) / 2), std::int32_t((window.height - size.height) / 2)}, size};
}

Mirror::Mirror(const Device& device, VkFormat format, VkExtent2D most)
    : values_(device, imageInfo(format, most), "the mirror window's image") {}

// Copies bit by bit first: a blit would decode the values of an SRGB source, and the window's frame is UNORM.
void Mirror::record(VkCommandBuffer commands, const MirrorSource& source,
                    const Swapchain::Frame& frame) const noexcept {
  constexpr ImageUse kDiscardedUse{VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_NONE};
  const VkImageSubresourceRange layer{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, source.layer, 1};
  const VkExtent2D extent{std::min(source.rect.extent.width, values_.info().extent.width),
                          std::min(source.rect.extent.height, values_.info().extent.height)};
  transition(commands, source.image, source.use, use::kTransferSource, layer);
  transition(commands, values_.get(), kDiscardedUse, use::kTransferDestination);
  recordRawCopy(commands, {source.image, source.rect.offset, source.layer}, {values_.get()}, extent);
  transition(commands, source.image, use::kTransferSource, source.use, layer);
  transition(commands, values_.get(), use::kTransferDestination, use::kTransferSource);

  transition(commands, frame.image, Swapchain::kInitialUse, use::kTransferDestination);
  clear(commands, frame.image);
  transition(commands, frame.image, use::kTransferDestination, use::kTransferDestination);
  const VkRect2D shown = letterbox(extent, frame.extent);
  const VkOffset3D low{shown.offset.x, shown.offset.y, 0};
  const VkImageBlit region{
      kColour,
      {{0, 0, 0}, {std::int32_t(extent.width), std::int32_t(extent.height), 1}},
      kColour,
      {low, {low.x + std::int32_t(shown.extent.width), low.y + std::int32_t(shown.extent.height), 1}}};
  vkCmdBlitImage(commands, values_.get(), use::kTransferSource.layout, frame.image, use::kTransferDestination.layout, 1,
                 &region, VK_FILTER_LINEAR);
  transition(commands, frame.image, use::kTransferDestination, Swapchain::kFinalUse);
}

}  // namespace ibr::app
