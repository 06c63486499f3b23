// SPDX-License-Identifier: Apache-2.0
#include "ibr/texture.h"

#include <algorithm>
#include <cassert>
#include <cstring>

#include "base/check.h"
#include "image/bc1.h"
#include "image/bc7.h"

namespace ibr {
namespace {

bool isBlocks(TextureFormat format) noexcept {
  return format == TextureFormat::bc1 || format == TextureFormat::bc7;
}

std::size_t blockBytes(TextureFormat format) noexcept {
  return format == TextureFormat::bc1 ? kBc1BlockBytes : kBc7BlockBytes;
}

// Calls visit(x, y) for each 4×4 block, row by row; (x, y) is its first pixel.
template <class Visit>
void forBlocks(int width, int height, Visit visit) {
  for (int y = 0; y < height; y += 4)
    for (int x = 0; x < width; x += 4) visit(x, y);
}

std::vector<std::byte> encodeLevel(const Image8& image, TextureFormat format) {
  std::vector<std::byte> bytes(textureBytes(format, image.width, image.height));
  std::byte* out = bytes.data();
  forBlocks(image.width, image.height, [&](int x0, int y0) {
    // Pixels beyond the image are never sampled: they repeat the border, which compresses best.
    BlockPixels pixels;
    for (int i = 0; i < 16; ++i)
      std::ranges::copy(image.pixel(std::min(x0 + i % 4, image.width - 1), std::min(y0 + i / 4, image.height - 1)),
                        pixels[std::size_t(i)].begin());
    if (format == TextureFormat::bc1)
      encodeBc1(pixels, std::span<std::byte, kBc1BlockBytes>(out, kBc1BlockBytes));
    else
      encodeBc7(pixels, std::span<std::byte, kBc7BlockBytes>(out, kBc7BlockBytes));
    out += blockBytes(format);
  });
  return bytes;
}

Image8 decodeLevel(const std::vector<std::byte>& bytes, TextureFormat format, int width, int height) {
  check(bytes.size() == textureBytes(format, width, height), ErrorCode::invalidInput,
        "a texture level of {}x{} in {} has {} bytes, not {}", width, height, textureFormatName(format), bytes.size(),
        textureBytes(format, width, height));
  check(format != TextureFormat::rg16f, ErrorCode::unsupported,
        "a texture in rg16f holds depth, not an image; read it with readDepthTexture");
  Image8 image(width, height, 4);
  if (format == TextureFormat::rgba8) {
    std::memcpy(image.values.data(), bytes.data(), bytes.size());
    return image;
  }
  const std::byte* in = bytes.data();
  forBlocks(width, height, [&](int x0, int y0) {
    BlockPixels pixels;
    if (format == TextureFormat::bc1)
      pixels = decodeBc1(std::span<const std::byte, kBc1BlockBytes>(in, kBc1BlockBytes));
    else
      check(decodeBc7(std::span<const std::byte, kBc7BlockBytes>(in, kBc7BlockBytes), pixels), ErrorCode::unsupported,
            "a BC7 block has another mode than 6, which the decoder does not support; use a device that samples BC7");
    for (int y = y0; y < std::min(y0 + 4, height); ++y)
      for (int x = x0; x < std::min(x0 + 4, width); ++x)
        std::ranges::copy(pixels[std::size_t(4 * (y - y0) + x - x0)], image.pixel(x, y).begin());
    in += blockBytes(format);
  });
  return image;
}

int side(int first, std::size_t level) noexcept {
  return std::max(1, first >> level);
}

void checkChain(const std::vector<Image8>& levels) {
  for (std::size_t l = 0; l < levels.size(); ++l) {
    const Image8& level = levels[l];
    const int width = side(levels[0].width, l), height = side(levels[0].height, l);
    const bool redundant = l > 0 && levels[l - 1].width == 1 && levels[l - 1].height == 1;
    check(level.channels == 4 && level.width == width && level.height == height && !redundant &&
              level.values.size() == std::size_t(width) * std::size_t(height) * 4,
          ErrorCode::invalidInput, "level {} is {}x{} with {} channels, not {}x{} with 4", l, level.width, level.height,
          level.channels, width, height);
  }
}

}  // namespace

const char* textureFormatName(TextureFormat format) noexcept {
  constexpr const char* kNames[]{"rgba8", "bc1", "bc7", "rg16f"};
  return kNames[std::size_t(format)];
}

std::uint64_t textureBytes(TextureFormat format, int width, int height) noexcept {
  const auto w = std::uint64_t(width), h = std::uint64_t(height);
  return isBlocks(format) ? (w + 3) / 4 * ((h + 3) / 4) * blockBytes(format) : 4 * w * h;
}

Texture::Texture(const std::vector<Image8>& rgba) : Texture(encodeTexture(rgba, TextureFormat::rgba8)) {}

Texture withoutLargestLevels(const Texture& texture, int firstLevel) {
  const auto first = std::size_t(firstLevel);
  assert(firstLevel >= 0 && first < texture.levels.size());
  Texture result;
  result.format = texture.format;
  result.width = side(texture.width, first);
  result.height = side(texture.height, first);
  result.levels.assign(texture.levels.begin() + firstLevel, texture.levels.end());
  return result;
}

Texture encodeTexture(const std::vector<Image8>& rgba, TextureFormat format) {
  check(format != TextureFormat::rg16f, ErrorCode::invalidInput,
        "rg16f holds depth, not images; choose rgba8, bc7 or bc1");
  checkChain(rgba);
  Texture texture;
  texture.format = format;
  if (rgba.empty()) return texture;
  texture.width = rgba[0].width;
  texture.height = rgba[0].height;
  for (const Image8& level : rgba) {
    if (format == TextureFormat::rgba8) {
      const auto bytes = std::as_bytes(std::span(level.values));
      texture.levels.emplace_back(bytes.begin(), bytes.end());
    } else {
      texture.levels.push_back(encodeLevel(level, format));
    }
  }
  return texture;
}

std::vector<Image8> decodeTexture(const Texture& texture) {
  std::vector<Image8> levels;
  for (std::size_t l = 0; l < texture.levels.size(); ++l)
    levels.push_back(decodeLevel(texture.levels[l], texture.format, side(texture.width, l), side(texture.height, l)));
  return levels;
}

}  // namespace ibr
