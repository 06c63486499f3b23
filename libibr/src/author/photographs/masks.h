// SPDX-License-Identifier: Apache-2.0
// Masks of photographs: what of them is neither matched nor shown, because it moved.
//
// As COLMAP has them: an 8-bit picture of the photograph's own size, 0 where it is ignored, anything else where it is
// used. That of a/b.jpg is a/b.jpg.png or a/b.png below the folder of masks. In memory and in a scene a mask has the
// stored photograph's size, one channel, and is 0 or 255; an empty one stands for no mask.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/vec2.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "author/photographs/photographs.h"
#include "ibr/author.h"
#include "ibr/image.h"

namespace ibr {

/// nullopt where there is none.
std::optional<std::filesystem::path> maskFileOf(const std::filesystem::path& folder, const std::string& photograph);

/// Where a scene keeps it: as COLMAP looks for it below "masks".
std::filesystem::path storedMaskFile(const std::string& photograph);

/// Throws Error{invalidInput} that names both files where the mask has another size than the photograph's file.
void checkMaskSize(const Photograph& photograph, const std::filesystem::path& file);

/// Goes the photograph's way: turned, undistorted, resized; a pixel of which a quarter is ignored is. Throws Error (io,
/// invalidInput) that names the file.
Image8 loadMask(const Photograph& photograph, const std::filesystem::path& file);

/// What the scene has stored for it (Photograph::storedMask); empty where there is none. Throws Error.
Image8 storedMask(const Photograph& photograph);

/// A scene's mask, from its file. Throws Error (io, invalidInput) that names it where it has not the camera's size.
Image8 readMask(const std::filesystem::path& file, const Intrinsics& camera);

/// At another size: a pixel of which a quarter is ignored is.
Image8 resizedMask(const Image8& mask, int width, int height);

/// Of a mask's means: a pixel of which a quarter is ignored is.
Image8 binaryMask(Image8 means);

/// With `px` more around all that is ignored; one pixel of a mask is a square of them.
Image8 widenedMask(const Image8& mask, int px);

/// What is ignored in either. Precondition: equal sizes.
Image8 bothMasks(const Image8& a, const Image8& b);

/// 0 to 1. None is ignored of an empty one.
double ignoredShare(const Image8& mask);

/// Whether the pixel that holds `at` is ignored; outside, as at the border. Nothing is where there is no mask.
inline bool isIgnored(const Image8& mask, glm::vec2 at) {
  if (mask.empty()) return false;
  const int x = at.x > 0 ? int(at.x) : 0, y = at.y > 0 ? int(at.y) : 0;
  return !mask.pixel(x < mask.width ? x : mask.width - 1, y < mask.height ? y : mask.height - 1)[0];
}

/// RGBA: the mask as alpha, and under it colours from around, so that no smaller size and no block of a texture mixes
/// in what is not to be seen. Precondition: equal sizes.
Image8 withMask(const Image8& rgb, const Image8& mask);

/// RGB: the picture, with colours from around where it is masked: nothing is to be found there. Precondition: equal
/// sizes, or no mask.
Image8 withoutMasked(const Image8& rgb, const Image8& mask);

/// Leaves out the observations of an image that its mask, of any size, covers. `tracks`: those that have one of it.
/// Tracks without any are left.
void dropIgnored(PosedModel& model, std::uint32_t image, const std::vector<std::uint32_t>& tracks, const Image8& mask);

/// Leaves out tracks that nobody sees.
void dropUnseen(PosedModel& model);

}  // namespace ibr
