// SPDX-License-Identifier: Apache-2.0
// Masks of photographs: pixels that are neither matched nor shown, because they moved.
//
// COLMAP's format: an 8-bit image of the photograph's own size, 0 where ignored, any other value where used. The mask
// of a/b.jpg is a/b.jpg.png or a/b.png below the folder of masks. In memory and in a scene a mask has the stored
// photograph's size, one channel, and is 0 or 255; an empty image means no mask.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/vec2.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "author/photographs/photographs.h"
#include "ibr/author/photographs.h"
#include "ibr/author/poses.h"
#include "ibr/image.h"

namespace ibr {

/// Path of a stored mask in a scene: where COLMAP looks below "masks".
std::filesystem::path storedMaskFile(const std::string& photograph);

/// Throws Error{invalidInput} that names both files if the mask and the photograph's file differ in size.
void checkMaskSize(const Photograph& photograph, const std::filesystem::path& file);

/// Rotates, undistorts and resizes the mask like the photograph; a pixel that is a quarter ignored is ignored. Throws
/// Error (io, invalidInput) that names the file.
Image8 loadMask(const Photograph& photograph, const std::filesystem::path& file);

/// Reads the scene's mask of the photograph (Photograph::storedMask); empty if there is none. Throws Error.
Image8 storedMask(const Photograph& photograph);

/// Reads a scene's mask. Throws Error (io, invalidInput) that names the file unless it has the camera's size.
Image8 readMask(const std::filesystem::path& file, const Intrinsics& camera);

/// Resizes a mask: a pixel that is a quarter ignored is ignored.
Image8 resizedMask(const Image8& mask, int width, int height);

/// Binarises averaged mask values: a pixel that is a quarter ignored is ignored.
Image8 binaryMask(Image8 means);

/// Widens the ignored areas by `px`, with a square structuring element.
Image8 widenedMask(const Image8& mask, int px);

/// Ignores the pixels that either mask ignores. Precondition: equal sizes.
Image8 combinedMask(const Image8& a, const Image8& b);

/// Share of ignored pixels, 0 to 1; 0 for an empty mask.
double ignoredShare(const Image8& mask);

/// True if the pixel that contains `at` is ignored. Outside, the border pixel counts; false for an empty mask.
inline bool isIgnored(const Image8& mask, glm::vec2 at) {
  if (mask.empty()) return false;
  const int x = at.x > 0 ? int(at.x) : 0, y = at.y > 0 ? int(at.y) : 0;
  return !mask.pixel(x < mask.width ? x : mask.width - 1, y < mask.height ? y : mask.height - 1)[0];
}

/// RGBA with the mask as alpha. Masked colours are filled from around, so that neither smaller mip levels nor texture
/// blocks mix in hidden colours. Precondition: equal sizes.
Image8 withMask(const Image8& rgb, const Image8& mask);

/// RGB with masked pixels filled from around, so that no features are found there. Precondition: equal sizes, or no
/// mask.
Image8 fillMasked(const Image8& rgb, const Image8& mask);

/// Removes the image's observations that its mask, of any size, covers. `tracks`: the tracks with an observation in the
/// image. Tracks without observations are kept.
void dropMaskedObservations(PosedModel& model, std::uint32_t image, const std::vector<std::uint32_t>& tracks,
                            const Image8& mask);

/// Removes tracks without observations.
void dropUnobservedTracks(PosedModel& model);

}  // namespace ibr
