// SPDX-License-Identifier: Apache-2.0
// Baked textures as KTX 2.0 files (Khronos specification 2.0.4): one image with its mip chain, RGBA8, BC1 or BC7, or a
// photograph's depth as two half floats (VK_FORMAT_R16G16_SFLOAT, linear).
//
// Image files state VK_FORMAT_R8G8B8A8_SRGB, BC1_RGB_SRGB_BLOCK or BC7_SRGB_BLOCK, since their values are
// display-encoded. The renderer samples the values unchanged (UNORM), because the papers blend display-encoded values.
// UNORM files can be read, too.
#pragma once

#include <cstdint>
#include <filesystem>

#include "ibr/texture.h"

namespace ibr {

struct Ktx2Info {
  std::uint32_t vkFormat = 0;  // VkFormat as stated in the file
  TextureFormat format = TextureFormat::rgba8;
  int width = 0, height = 0;  // of level 0
  int levels = 0;
};

/// The levels may end before 1×1. Throws Error (io; invalidInput if levels and sizes do not match).
void writeKtx2(const std::filesystem::path& path, const Texture& texture);

/// Reads no pixels, but makes all checks of readKtx2. Throws as readKtx2.
Ktx2Info probeKtx2(const std::filesystem::path& path);

/// Reads level `firstLevel` and the smaller ones, which are contiguous, and nothing else. Throws Error (io,
/// invalidInput; unsupported for other formats, cubes, arrays and supercompression) with file and field.
Texture readKtx2(const std::filesystem::path& path, int firstLevel = 0);

}  // namespace ibr
