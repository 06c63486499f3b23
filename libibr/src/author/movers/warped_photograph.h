// SPDX-License-Identifier: Apache-2.0
// Photographs at half the matched size, and their images as seen from another camera through known depth.
#pragma once

#include <opencv2/core.hpp>

#include "author/geometry/match_view.h"
#include "ibr/camera.h"
#include "ibr/image.h"

namespace ibr {

/// A photograph at half the size of its MatchView, but at least 1 px.
struct HalfSizeView {
  Camera camera;   // a pinhole, of the half size
  cv::Mat colour;  // RGB, float, 8-bit levels
  cv::Mat used;    // 8 bits, 255: not masked
};

/// `maskMarginPx`: width by which the mask is widened, px of the half size.
HalfSizeView halfSizeView(const MatchView& view, int maskMarginPx);

/// A photograph warped to a frame, or to a box in the frame. Colours outside the photograph repeat its border.
struct WarpedPhotograph {
  cv::Mat colour;  // RGB, float, 8-bit levels
  cv::Mat inside;  // 8 bits, 255: at least 1 px inside the photograph's image, and not masked
};

/// `frame`: a pinhole. `inverseDepth`: along the frame's axis, 1 / world unit, 0 = infinity; of the frame's size.
WarpedPhotograph warpedThrough(const ImageF& inverseDepth, const Camera& frame, const HalfSizeView& photograph);

/// Warps to the box through a plane of constant inverse depth. `box`: within the frame, px.
WarpedPhotograph warpedAtDepth(float inverseDepth, const Camera& frame, cv::Rect box, const HalfSizeView& photograph);

}  // namespace ibr
