// SPDX-License-Identifier: Apache-2.0
// Baked textures as KTX 2.0 files (Khronos specification 2.0.4): one picture with its mip chain, RGBA8.
//
// The file says VK_FORMAT_R8G8B8A8_SRGB, which is what the values are: display-encoded. The renderer samples them as
// they are (UNORM), since the papers blend display-encoded values.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "ibr/image.h"

namespace ibr {

/// Precondition: RGBA levels as buildMips makes them, the largest first. Throws Error{io}.
void writeKtx2(const std::filesystem::path& path, std::span<const Image8> levels);

/// Largest level first. Throws Error (io, invalidInput, unsupported) that names file and field.
std::vector<Image8> readKtx2(const std::filesystem::path& path);

}  // namespace ibr
