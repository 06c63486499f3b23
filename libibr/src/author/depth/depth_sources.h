// SPDX-License-Identifier: Apache-2.0
// Chooses the views that a view's depth is matched against, whatever their viewing direction.
//
// The weight of a track in another view is g(angle) · min(r_i/r_j, r_j/r_i) · (1 if both observe the track, else 0.3).
// Here r are the distances, the angle is the parallax and g a Gaussian about the best parallax. Tracks are equalised
// over a grid on the image. Greedy choice: the view that adds most to Σ √(sum of a track's weights) is next.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "author/depth/depth_views.h"
#include "ibr/author/poses.h"

namespace ibr {

inline constexpr std::size_t kNearSources = 6;  // at parallaxes near 6°
inline constexpr std::size_t kWideSources = 4;  // at parallaxes up to 25°, which determine depth more precisely

/// At most kNearSources + kWideSources other views, indices into `views`, in the order of the greedy choice. Skips
/// views at the view's own position. `views`: of the model's images, at any size. `tracksOf`: from tracksOfImages. Does
/// not depend on the order of the tracks' observations.
std::vector<std::uint32_t> depthSources(const PosedModel& model, std::span<const DepthView> views,
                                        std::span<const std::vector<std::uint32_t>> tracksOf, std::uint32_t view);

}  // namespace ibr
