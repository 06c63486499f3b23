// SPDX-License-Identifier: Apache-2.0
// Corrects surface borders in a swept depth map. A window across a silhouette matches best at the foreground's depth,
// wherever its centre lies, so foregrounds are fattened.
#pragma once

#include <span>

#include "author/sweep/plane_sweep.h"

namespace ibr {

/// Assigns pixels in front of a depth edge to the surface behind, in place, from the edge inwards by at most four
/// pixels. The surface behind must explain the pixel as well as the foreground, without an image edge between; at an
/// image edge it must explain the pixel clearly better. A surface explains a pixel well if members differ little over a
/// window, whose pixels are weighted by similarity to the pixel's colour (Yoon & Kweon 2006). Of three or more members
/// the outlier is ignored, since it may see the foreground. `level` is in levels of `range`, in the frame's pixels, as
/// is `guide`. Precondition: at most kMaxMembers views.
void trimForegrounds(const Camera& frame, std::span<const SweepView> views, const SweepLevels& range,
                     const ImageF& guide, ImageF& level);

}  // namespace ibr
