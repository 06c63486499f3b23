// SPDX-License-Identifier: Apache-2.0
// Properties of the formats that libibr uses: encoding and sizes.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>

namespace ibr {

/// True if writes are sRGB-encoded by the format.
constexpr bool isSrgb(VkFormat format) noexcept {
  return format == VK_FORMAT_R8G8B8A8_SRGB || format == VK_FORMAT_B8G8R8A8_SRGB;
}

/// True for 8-bit RGBA or BGRA.
constexpr bool isRgba8Format(VkFormat format) noexcept {
  return isSrgb(format) || format == VK_FORMAT_R8G8B8A8_UNORM || format == VK_FORMAT_B8G8R8A8_UNORM;
}

/// Bytes per texel, or per block of blockSide² texels; 0 for other formats.
constexpr std::uint32_t blockBytes(VkFormat format) noexcept {
  switch (format) {
    case VK_FORMAT_R8_UNORM:
    case VK_FORMAT_R8_UINT:
      return 1;
    case VK_FORMAT_R8G8_UNORM:
    case VK_FORMAT_R16_UNORM:
    case VK_FORMAT_R16_UINT:
    case VK_FORMAT_R16_SFLOAT:
      return 2;
    case VK_FORMAT_R8G8B8A8_UNORM:
    case VK_FORMAT_R8G8B8A8_SRGB:
    case VK_FORMAT_R8G8B8A8_UINT:
    case VK_FORMAT_B8G8R8A8_UNORM:
    case VK_FORMAT_B8G8R8A8_SRGB:
    case VK_FORMAT_A2B10G10R10_UNORM_PACK32:
    case VK_FORMAT_R16G16_SFLOAT:
    case VK_FORMAT_R32_UINT:
    case VK_FORMAT_R32_SFLOAT:
    case VK_FORMAT_D32_SFLOAT:
      return 4;
    case VK_FORMAT_R16G16B16A16_SFLOAT:
    case VK_FORMAT_R32G32_UINT:
    case VK_FORMAT_R32G32_SFLOAT:
    case VK_FORMAT_BC1_RGB_UNORM_BLOCK:
      return 8;
    case VK_FORMAT_R32G32B32A32_UINT:
    case VK_FORMAT_R32G32B32A32_SFLOAT:
    case VK_FORMAT_BC7_UNORM_BLOCK:
      return 16;
    default:
      return 0;
  }
}

constexpr std::uint32_t blockSide(VkFormat format) noexcept {
  return format == VK_FORMAT_BC1_RGB_UNORM_BLOCK || format == VK_FORMAT_BC7_UNORM_BLOCK ? 4 : 1;
}

/// Number of blocks that cover a row or column of `texels` texels.
constexpr std::uint32_t blockCount(VkFormat format, std::uint32_t texels) noexcept {
  return (texels + blockSide(format) - 1) / blockSide(format);
}

}  // namespace ibr
