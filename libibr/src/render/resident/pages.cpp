// SPDX-License-Identifier: Apache-2.0
#include "render/resident/pages.h"

#include <algorithm>
#include <bit>

#include "base/check.h"

namespace ibr {
namespace {

VkExtent2D levelExtent(VkExtent2D extent, std::uint32_t level) noexcept {
  return {std::max(1u, extent.width >> level), std::max(1u, extent.height >> level)};
}

// Calls visit(first, count) for the photographs of each texture array, by their index in the class.
template <class Visit>
void forPages(const Device& device, const PageClass& pageClass, Visit visit) {
  const std::uint32_t most = layersWithin(device, pageClass, kLargestPageBytes);
  const auto count = std::uint32_t(pageClass.nodes.size());
  for (std::uint32_t first = 0; first < count; first += most) visit(first, std::min(most, count - first));
}

}  // namespace

VkFormat vulkanFormat(TextureFormat format) noexcept {
  switch (format) {
    case TextureFormat::bc1:
      return VK_FORMAT_BC1_RGB_UNORM_BLOCK;
    case TextureFormat::bc7:
      return VK_FORMAT_BC7_UNORM_BLOCK;
    case TextureFormat::rg16f:
      return VK_FORMAT_R16G16_SFLOAT;
    case TextureFormat::rgba8:
      break;
  }
  return VK_FORMAT_R8G8B8A8_UNORM;
}

std::uint32_t PageClass::levels() const noexcept {
  return std::uint32_t(std::bit_width(std::max(extent.width, extent.height))) - firstLevel;
}

VkExtent2D PageClass::pageExtent() const noexcept {
  return levelExtent(extent, firstLevel);
}

std::uint64_t PageClass::layerBytes() const noexcept {
  std::uint64_t bytes = 0;
  for (std::uint32_t level = 0; level < levels(); ++level) {
    const VkExtent2D size = levelExtent(extent, firstLevel + level);
    bytes += textureBytes(format, int(size.width), int(size.height));
  }
  return bytes;
}

std::string PageClass::text() const {
  return fmt::format("photographs {}x{} as {}", extent.width, extent.height, textureFormatName(format));
}

GpuImageInfo pageInfo(const PageClass& pageClass, std::uint32_t layers) noexcept {
  return {.format = vulkanFormat(pageClass.format),
          .extent = pageClass.pageExtent(),
          .layers = layers,
          .mipLevels = pageClass.levels(),
          .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT,
          .viewType = VK_IMAGE_VIEW_TYPE_2D_ARRAY};
}

std::uint32_t layersWithin(const Device& device, const PageClass& pageClass, std::uint64_t bytes) {
  const auto most = std::min<std::uint64_t>(device.properties().limits.maxImageArrayLayers, pageClass.nodes.size());
  return std::uint32_t(std::clamp<std::uint64_t>(bytes / pageClass.layerBytes(), 1, most));
}

FixedPages::FixedPages(const Device& device, std::span<const PageClass> classes, std::size_t nodeCount)
    : places_(nodeCount) {
  for (const PageClass& pageClass : classes)
    forPages(device, pageClass, [&](std::uint32_t first, std::uint32_t count) {
      for (std::uint32_t i = 0; i < count; ++i) places_[pageClass.nodes[first + i]] = {std::uint32_t(pages_.size()), i};
      pages_.emplace_back(device, pageInfo(pageClass, count), pageClass.text());
    });
}

std::uint64_t FixedPages::bytes(const Device& device, std::span<const PageClass> classes) {
  std::uint64_t bytes = 0;
  for (const PageClass& pageClass : classes) {
    std::uint32_t lastCount = 0;
    std::uint64_t lastBytes = 0;
    forPages(device, pageClass, [&](std::uint32_t, std::uint32_t count) {
      if (count != lastCount) lastBytes = allocationBytes(device, pageInfo(pageClass, count), pageClass.text());
      lastCount = count;
      bytes += lastBytes;
    });
  }
  return bytes;
}

std::uint64_t FixedPages::allocatedBytes() const noexcept {
  std::uint64_t bytes = 0;
  for (const GpuImage& page : pages_) bytes += page.allocatedBytes();
  return bytes;
}

}  // namespace ibr
