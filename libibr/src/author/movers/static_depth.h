// SPDX-License-Identifier: Apache-2.0
// Depth of static surfaces, without that of moving objects. Depth maps hold inverse depth along the view's axis,
// 1 / world unit, and kUnknownDepth where unknown (complete_depth.h).
#pragma once

#include <opencv2/core.hpp>
#include <span>

#include "author/movers/warped_photograph.h"
#include "ibr/image.h"

namespace ibr {

/// Returns a depth map at another size. Takes the nearest pixel: interpolation between two surfaces would invent depth.
ImageF resampledDepth(const ImageF& inverseDepth, int width, int height);

/// Drops depth at which no other photograph looks alike, as on a moving object, and depth of masked pixels. Areas that
/// look alike must contain a disc of radius `minRadiusPx`; a smaller one is chance. `inverseDepth`: of the view's size.
ImageF confirmedDepth(ImageF inverseDepth, const HalfSizeView& view, std::span<const HalfSizeView> others,
                      double minRadiusPx);

/// Replaces depth where `where` (8 bits, of the map's size) is not 0, without using colours: inverse depth becomes
/// harmonic between the other pixels, as on any plane. Starts from the given values, which must be known.
ImageF harmonicDepth(ImageF inverseDepth, const cv::Mat& where);

}  // namespace ibr
