// SPDX-License-Identifier: Apache-2.0
// Cleans a matcher's depth map: smooths outliers, replaces speckles, fits planes.
#pragma once

#include <vector>

#include "ibr/image.h"

namespace ibr {

/// Marks the pixels of connected regions (neighbours differ by at most `step`) of fewer than `least` pixels.
std::vector<bool> speckles(const ImageF& map, float step, int least);

/// In place: median of 5×5. Speckles are then filled from the nearest remaining pixel to the left or right in their
/// row, whichever is smaller: the farther one for inverse depths. One channel.
void cleanDepth(ImageF& inverseDepth, float step, int least);

/// Returns inverse depth and its change per pixel in x and y (3 channels): a plane fitted around each pixel to pixels
/// of similar depth. A plane surface has linear inverse depth in the image, so the fit loses nothing there. `step` is
/// the matcher's, in units of the map.
ImageF fitPlanes(const ImageF& inverseDepth, float step);

/// Resamples the map by the plane of the nearest pixel: no values between two surfaces appear.
ImageF enlarged(const ImageF& planes, int width, int height);

}  // namespace ibr
