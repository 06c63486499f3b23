// SPDX-License-Identifier: Apache-2.0
// Photographs as textures: RGBA8, or blocks of 4 × 4 pixels that the device decodes while it samples.
//
//   format   bytes a pixel   what it costs
//   rgba8    4               nothing is lost
//   bc7      1               mode 6 alone: colours of a block on one line, 16 steps; about 46 dB on photographs
//   bc1      ½               [T] §2.6.3, as the paper stores them: 4 steps, 5 or 6 bits; 35 to 38 dB
//
//   rg16f    4               no photograph but its depth (Node::depthFile): two half floats
//
// Values of photographs are display-encoded in all formats, and are sampled as they are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "ibr/image.h"

namespace ibr {

enum class TextureFormat : std::uint8_t { rgba8, bc1, bc7, rg16f };

/// "rgba8", "bc1", "bc7", "rg16f".
const char* textureFormatName(TextureFormat format) noexcept;

/// Bytes of a picture. Blocks count whole, also where the picture ends inside one.
std::uint64_t textureBytes(TextureFormat format, int width, int height) noexcept;

/// A picture and its mip levels, or the smaller ones of them.
struct Texture {
  TextureFormat format = TextureFormat::rgba8;
  int width = 0, height = 0;  // of the first level here; each further one has max(1, ⌊side / 2⌋)
  // Rows from the top, no padding: of pixels (red, green, blue, alpha), or of blocks, the first at the top left.
  std::vector<std::vector<std::byte>> levels;

  Texture() = default;
  /// From RGBA8 levels, as a function that makes pictures returns them. Throws Error{invalidInput} unless each has four
  /// channels and the size that follows from the first.
  Texture(const std::vector<Image8>& rgba);  // NOLINT: meant to convert
  bool operator==(const Texture&) const = default;
};

/// The texture without its first levels. Precondition: 0 <= firstLevel < the number of levels.
Texture smallerLevels(const Texture& texture, int firstLevel);

/// Encodes RGBA levels. Deterministic. Throws as Texture's constructor.
Texture encodeTexture(const std::vector<Image8>& rgba, TextureFormat format);

/// Back to RGBA8. BC1 as the formula says, rounded to the nearest (devices differ from it by 2 levels at most); BC7
/// exactly, but mode 6 alone: throws Error{unsupported} for blocks of other modes, Error{invalidInput} for levels whose
/// bytes do not fit their size.
std::vector<Image8> decodeTexture(const Texture& texture);

}  // namespace ibr
