// SPDX-License-Identifier: Apache-2.0
// Bundle adjustment within a cell, for matching only. A rotation that is wrong by 0.03° puts
// photographs half a pixel off each other, and a plane sweep finds nothing there; what one cell's tracks say about its
// few members is far more exact than what the whole model settled on. The morph keeps the model's poses.
//
// The first member is fixed; poses of the others and all points are free (bundle_adjust.h); a weak prior holds the
// poses, and with them the scale.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "ibr/author.h"

namespace ibr {

struct LocalTrack {
  glm::dvec3 position;                           // world
  std::vector<std::optional<glm::dvec2>> pixel;  // of each member, px of its camera; nullopt: not seen
};

/// Tracks that at least two of the members see, those that most of them see first, at most 1000. `tracksOf`: of each
/// image of the model, its tracks, ascending.
std::vector<LocalTrack> localTracks(const PosedModel& model, std::span<const std::vector<std::uint32_t>> tracksOf,
                                    std::span<const std::uint32_t> members);

/// The members' poses, adjusted; as they are where tracks are few or the poses fit them already, to a median
/// reprojection error below `leastPx`. Cameras are pinholes.
std::vector<Pose> locallyAdjusted(std::span<const Camera> members, std::span<const LocalTrack> tracks,
                                  double leastPx = 0.1);

}  // namespace ibr
