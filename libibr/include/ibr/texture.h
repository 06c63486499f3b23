// SPDX-License-Identifier: Apache-2.0
// Photographs as textures: RGBA8, or compressed blocks of 4 × 4 pixels that the device decodes while sampling.
//
//   format   bytes a pixel   contents
//   rgba8    4               lossless
//   bc7      1               mode 6 only: colours of a block on one line in 16 steps; PSNR about 46 dB
//   bc1      ½               as in [T] §2.6.3: colours of a block in 4 steps, 5 or 6 bits a channel; PSNR 35 to 38 dB
//
//   rg16f    4               depth of a photograph (Node::depthFile), two half floats
//
// Photographs are display-encoded in all formats, and are sampled without conversion.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "ibr/export.h"
#include "ibr/image.h"

namespace ibr {

/// Format of a texture; see the table in ibr/texture.h.
enum class TextureFormat : std::uint8_t {
  rgba8,  // 8 bits for each of R, G, B, A; lossless, 4 bytes a pixel
  bc1,    // blocks of 4 × 4 pixels with 8 bytes; no alpha
  bc7,    // blocks of 4 × 4 pixels with 16 bytes
  rg16f   // two half floats a pixel: depth and consensus (Node::depthFile)
};

/// Returns "rgba8", "bc1", "bc7" or "rg16f".
IBR_API const char* textureFormatName(TextureFormat format) noexcept;

/// Returns the bytes of an image or mip level. Blocks that the image fills in part count in full.
IBR_API std::uint64_t textureBytes(TextureFormat format, int width, int height) noexcept;

/// An image and its mip levels. The largest levels may be left out.
struct Texture {
  TextureFormat format = TextureFormat::rgba8;  // format of all levels
  int width = 0, height = 0;                    // size of levels[0], px; each further level has max(1, ⌊side / 2⌋)
  /// Levels, largest first. Rows from the top, no padding: pixels (RGBA, or red and green halves), or blocks, the first
  /// at the top left.
  std::vector<std::vector<std::byte>> levels;

  Texture() = default;  // without levels
  /// Makes an rgba8 texture from RGBA levels, largest first. Throws Error{invalidInput} unless each level has four
  /// channels and the size that follows from the first level's.
  IBR_API Texture(const std::vector<Image8>& rgba);  // NOLINT: implicit on purpose
  bool operator==(const Texture&) const = default;
};

/// Returns the texture without its first `firstLevel` levels. Precondition: 0 <= firstLevel < the number of levels.
IBR_API Texture withoutLargestLevels(const Texture& texture, int firstLevel);

/// Encodes RGBA levels, largest first. Deterministic. Throws Error{invalidInput} for rg16f, and as Texture(rgba).
IBR_API Texture encodeTexture(const std::vector<Image8>& rgba, TextureFormat format);

/// Decodes all levels to RGBA8. BC1 is rounded to the nearest; devices differ by at most 2 of 255. BC7 is exact. Throws
/// Error{unsupported} for rg16f and for BC7 blocks of other modes than 6, and Error{invalidInput} for levels whose
/// number of bytes does not match their size.
IBR_API std::vector<Image8> decodeTexture(const Texture& texture);

/// Returns RGBA8 levels from the image itself (alpha 255 for RGB) down to 1×1, each max(1, ⌊side / 2⌋) of the previous.
/// Each level is the exact box filter of the previous one in linear light, also for odd sizes. Deterministic. Throws
/// Error{invalidInput} unless the image has 3 or 4 channels and at least one pixel.
IBR_API std::vector<Image8> buildMips(const Image8& rgbOrRgba);

/// Header of a KTX 2.0 file (Khronos specification 2.0.4) of one image with its levels. Photographs are stated as _SRGB
/// formats, since their values are display-encoded; _UNORM files are read, too. rg16f is stated as
/// VK_FORMAT_R16G16_SFLOAT.
struct Ktx2Info {
  std::uint32_t vkFormat = 0;                   // VkFormat as stated in the file
  TextureFormat format = TextureFormat::rgba8;  // format that readKtx2 returns
  int width = 0, height = 0;                    // size of level 0, px
  int levels = 0;                               // number of levels in the file
};

/// Writes a KTX 2.0 file. The levels may end before 1×1. Throws Error (io; invalidInput if levels and sizes do not
/// match).
IBR_API void writeKtx2(const std::filesystem::path& path, const Texture& texture);

/// Reads the header. Reads no pixels, but makes all checks of readKtx2. Throws as readKtx2.
IBR_API Ktx2Info probeKtx2(const std::filesystem::path& path);

/// Reads level `firstLevel` and the smaller ones, which are contiguous, and nothing else. Throws Error (io,
/// invalidInput; unsupported for other formats, cubes, arrays and supercompression) with file and field.
IBR_API Texture readKtx2(const std::filesystem::path& path, int firstLevel = 0);

/// Depth of a photograph: two maps of one size, one channel each, that cover the photograph.
struct DepthMaps {
  ImageF inverseDepth;  // ρ, 1 / world unit, >= 0
  ImageF consensus;     // a, 0 to 1 (MorphMesh::consensus)
};

/// Decodes an rg16f texture; `scale`: Node::depthScale. Throws Error{invalidInput} for another format, more than one
/// level, a scale that is not finite and positive, or values that are negative or not finite.
IBR_API DepthMaps readDepthTexture(const Texture& texture, double scale);

}  // namespace ibr
