// SPDX-License-Identifier: Apache-2.0
#include "render/resident/texture_arrays.h"

#include <algorithm>
#include <bit>

#include "base/check.h"

namespace ibr {
namespace {

VkExtent2D levelExtent(VkExtent2D extent, std::uint32_t level) noexcept {
  return {std::max(1u, extent.width >> level), std::max(1u, extent.height >> level)};
}

// Calls visit(first, count) for the items of each texture array, by their index in the class.
template <class Visit>
void forArrays(const Device& device, const TextureArrayClass& arrayClass, Visit visit) {
  // The gather has few slots for arrays of depth textures.
  const std::uint32_t most =
      layersWithin(device, arrayClass, arrayClass.isDepth() ? ~std::uint64_t(0) : kMaxArrayBytes);
  const auto count = std::uint32_t(arrayClass.items.size());
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

std::uint32_t TextureArrayClass::levels() const noexcept {
  return isDepth() ? 1 : std::uint32_t(std::bit_width(std::max(extent.width, extent.height))) - firstLevel;
}

VkExtent2D TextureArrayClass::arrayExtent() const noexcept {
  return levelExtent(extent, firstLevel);
}

std::uint64_t TextureArrayClass::layerBytes() const noexcept {
  std::uint64_t bytes = 0;
  for (std::uint32_t level = 0; level < levels(); ++level) {
    const VkExtent2D size = levelExtent(extent, firstLevel + level);
    bytes += textureBytes(format, int(size.width), int(size.height));
  }
  return bytes;
}

std::string TextureArrayClass::text() const {
  if (isDepth()) return fmt::format("depth textures {}x{}", extent.width, extent.height);
  return fmt::format("photographs {}x{} as {}", extent.width, extent.height, textureFormatName(format));
}

GpuImageInfo arrayInfo(const TextureArrayClass& arrayClass, std::uint32_t layers) noexcept {
  return {.format = vulkanFormat(arrayClass.format),
          .extent = arrayClass.arrayExtent(),
          .layers = layers,
          .mipLevels = arrayClass.levels(),
          .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT,
          .viewType = VK_IMAGE_VIEW_TYPE_2D_ARRAY};
}

std::uint32_t layersWithin(const Device& device, const TextureArrayClass& arrayClass, std::uint64_t bytes) {
  const auto most = std::min<std::uint64_t>(device.properties().limits.maxImageArrayLayers, arrayClass.items.size());
  return std::uint32_t(std::clamp<std::uint64_t>(bytes / arrayClass.layerBytes(), 1, most));
}

FixedTextureArrays::FixedTextureArrays(const Device& device, std::span<const TextureArrayClass> classes,
                                       std::size_t itemCount)
    : slots_(itemCount) {
  for (const TextureArrayClass& arrayClass : classes)
    forArrays(device, arrayClass, [&](std::uint32_t first, std::uint32_t count) {
      for (std::uint32_t i = 0; i < count; ++i)
        slots_[arrayClass.items[first + i]] = {std::uint32_t(arrays_.size()), i};
      arrays_.emplace_back(device, arrayInfo(arrayClass, count), arrayClass.text());
    });
}

std::uint64_t FixedTextureArrays::bytes(const Device& device, std::span<const TextureArrayClass> classes) {
  std::uint64_t bytes = 0;
  for (const TextureArrayClass& arrayClass : classes) {
    std::uint32_t lastCount = 0;
    std::uint64_t lastBytes = 0;
    forArrays(device, arrayClass, [&](std::uint32_t, std::uint32_t count) {
      if (count != lastCount) lastBytes = allocationBytes(device, arrayInfo(arrayClass, count), arrayClass.text());
      lastCount = count;
      bytes += lastBytes;
    });
  }
  return bytes;
}

std::uint64_t FixedTextureArrays::depthBytes() const noexcept {
  std::uint64_t bytes = 0;
  for (const GpuImage& array : arrays_)
    if (array.info().format == vulkanFormat(TextureFormat::rg16f)) bytes += array.allocatedBytes();
  return bytes;
}

std::uint64_t FixedTextureArrays::allocatedBytes() const noexcept {
  std::uint64_t bytes = 0;
  for (const GpuImage& array : arrays_) bytes += array.allocatedBytes();
  return bytes;
}

}  // namespace ibr
