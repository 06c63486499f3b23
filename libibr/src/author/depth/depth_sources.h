// SPDX-License-Identifier: Apache-2.0
// Which views a view's depth is matched against, whatever way they look.
//
//   A track weighs in another view g(angle) · min(r_i/r_j, r_j/r_i) · (1 if both observe it, else .3), where r
//   are the distances, the angle is the parallax and g a Gaussian about the best parallax. Tracks are equalised over a
//   grid on the picture. Greedily: the view that adds most to Σ √(sum of a track's weights).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "author/depth/depth_views.h"
#include "ibr/author.h"

namespace ibr {

inline constexpr std::size_t kNearSources = 6;  // at parallaxes near 6°
inline constexpr std::size_t kWideSources = 4;  // at parallaxes up to 25°, which tell depth more precisely

/// At most kNearSources + kWideSources other views, indices into `views`; those chosen first are seen best. None stands
/// at the view's own place. `views`: of the model's images, at any size; `tracksOf` as of tracksOfImages. Does not
/// depend on the order of the tracks' observations.
std::vector<std::uint32_t> depthSources(const PosedModel& model, std::span<const DepthView> views,
                                        std::span<const std::vector<std::uint32_t>> tracksOf, std::uint32_t view);

}  // namespace ibr
