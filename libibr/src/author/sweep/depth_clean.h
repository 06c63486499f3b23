// SPDX-License-Identifier: Apache-2.0
// What a matcher's depth map needs before it can be believed: outliers smoothed away, speckles replaced.
#pragma once

#include <vector>

#include "ibr/image.h"

namespace ibr {

/// Marks the pixels of connected regions (neighbours differ by at most `step`) of fewer than `least` pixels.
std::vector<bool> speckles(const ImageF& map, float step, int least);

/// In place: median of 5×5; speckles are filled from the nearest remaining pixel to the left or right in their row,
/// whichever is smaller: farther away, when the values are inverse depths. One channel.
void cleanDepth(ImageF& inverseDepth, float step, int least);

/// Inverse depth and its change per pixel in x and y (3 channels): around each pixel a plane is fitted to what is near
/// it in depth as well. Where a surface is plane its inverse depth is linear in the picture, so nothing is lost there.
/// `step` is the matcher's, in units of the map.
ImageF fitPlanes(const ImageF& inverseDepth, float step);

/// The map at another size, by the plane of the nearest pixel: nothing floats between surfaces.
ImageF enlarged(const ImageF& planes, int width, int height);

}  // namespace ibr
