// SPDX-License-Identifier: Apache-2.0
// Bundle adjustment within a cell, for matching only. A rotation error of 0.03° misaligns photographs by half a pixel,
// and a plane sweep finds nothing. A cell's own tracks place its few members far more accurately than the whole model
// does. The morph keeps the model's poses.
//
// The first member is fixed; poses of the others and all points are free (bundle_adjust.h). A weak prior holds the
// poses, and with them the scale.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "ibr/author/poses.h"

namespace ibr {

struct LocalTrack {
  glm::dvec3 position;                           // world
  std::vector<std::optional<glm::dvec2>> pixel;  // for each member, px of its camera; nullopt: not seen
};

/// Returns at most 1000 tracks that at least two members see, those with most members first. `tracksOf`: for each image
/// of the model, its tracks, ascending.
std::vector<LocalTrack> localTracks(const PosedModel& model, std::span<const std::vector<std::uint32_t>> tracksOf,
                                    std::span<const std::uint32_t> members);

/// Returns the members' adjusted poses. They are unchanged if tracks are few, or the median reprojection error is below
/// `minErrorPx` already. Cameras are pinholes.
std::vector<Pose> locallyAdjusted(std::span<const Camera> members, std::span<const LocalTrack> tracks,
                                  double minErrorPx = 0.1);

}  // namespace ibr
