// SPDX-License-Identifier: Apache-2.0
// A furnished hall, textured everywhere, for a generated video of a walk.
#pragma once

#include <cstdint>
#include <vector>

#include "lab/generate/surface_texture.h"

namespace ibr {

/// An upright cylinder that nobody can stand in. Lengths in metres.
struct Obstacle {
  glm::dvec2 centre;  // x, z
  double radius, top;
};

/// 11 × 8 × 3.2 m, y up, the floor at y = 0, its middle at the origin. Things stand in the middle and along the walls;
/// the way between is at least 1.5 m wide.
struct WalkHall {
  std::vector<Surface> surfaces;
  std::vector<Obstacle> obstacles;

  /// True if a camera fits at the position: 0.35 m from walls, floor, ceiling and obstacles.
  bool hasRoom(glm::dvec3 position) const;
};

/// Deterministic for a seed.
WalkHall makeWalkHall(std::uint64_t seed);

}  // namespace ibr
