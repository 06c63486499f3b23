// SPDX-License-Identifier: Apache-2.0
// Baked textures as KTX 2.0 files (Khronos specification 2.0.4): one picture with its mip chain, RGBA8, BC1 or BC7, or
// the depth of a photograph as two half floats (VK_FORMAT_R16G16_SFLOAT, linear).
//
// The file of a picture says VK_FORMAT_R8G8B8A8_SRGB, BC1_RGB_SRGB_BLOCK or BC7_SRGB_BLOCK, which is what the values
// are: display-encoded. The renderer samples them as they are (UNORM), since the papers blend display-encoded values.
// Files that say UNORM are read too.
#pragma once

#include <cstdint>
#include <filesystem>

#include "ibr/texture.h"

namespace ibr {

struct Ktx2Info {
  std::uint32_t vkFormat = 0;  // as the file says: a VkFormat
  TextureFormat format = TextureFormat::rgba8;
  int width = 0, height = 0;  // of level 0
  int levels = 0;
};

/// The levels may end before 1×1. Throws Error (io; invalidInput where levels and sizes do not belong together).
void writeKtx2(const std::filesystem::path& path, const Texture& texture);

/// Reads no pixels, but checks all that readKtx2 checks. Throws as readKtx2.
Ktx2Info probeKtx2(const std::filesystem::path& path);

/// Level `firstLevel` of the file and the smaller ones, which lie together: nothing else is read. Throws Error (io,
/// invalidInput; unsupported for other formats, cubes, arrays and supercompression) that names file and field.
Texture readKtx2(const std::filesystem::path& path, int firstLevel = 0);

}  // namespace ibr
