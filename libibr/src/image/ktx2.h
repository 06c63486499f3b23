// SPDX-License-Identifier: Apache-2.0
// Baked textures as KTX 2.0 files (Khronos specification 2.0.4): one picture with its mip chain, RGBA8.
//
// The file says VK_FORMAT_R8G8B8A8_SRGB, which is what the values are: display-encoded. The renderer samples them as
// they are (UNORM), since the papers blend display-encoded values. Files that say UNORM are read too.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "ibr/image.h"

namespace ibr {

struct Ktx2Info {
  std::uint32_t vkFormat = 0;  // as the file says: a VkFormat
  int width = 0, height = 0;   // of level 0
  int levels = 0;
};

/// RGBA levels as buildMips makes them, the largest first; they may end early. Throws Error (io; invalidInput where
/// they do not belong together).
void writeKtx2(const std::filesystem::path& path, std::span<const Image8> levels);

/// Reads no pixels, but checks all that readKtx2 checks. Throws as readKtx2.
Ktx2Info probeKtx2(const std::filesystem::path& path);

/// Largest level first. Throws Error (io, invalidInput; unsupported for other formats, cubes, arrays and
/// supercompression) that names file and field.
std::vector<Image8> readKtx2(const std::filesystem::path& path);

}  // namespace ibr
