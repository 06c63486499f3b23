// SPDX-License-Identifier: Apache-2.0
// Shapes besides the scene: marks of spots, hands, fades, a floor while loading. Coloured triangles, three vertices
// each, double-sided, in blending order.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "vr/walk/spots.h"
#include "vr/walk/tracking.h"

namespace ibr::app {

struct ShapeVertex {
  glm::vec3 position{0.0f};
  std::uint32_t colour = 0;  // R8G8B8A8, red in the lowest byte; straight alpha, display-encoded
};

struct Shapes {
  std::vector<ShapeVertex> inSpace;  // tracking space, metres, tested against the scene's depth
  std::vector<ShapeVertex> onView;   // each eye's axes at z = −1: x and y are tangents; drawn over everything
};

inline constexpr std::size_t kMaxMarks = 500;

/// Adds a ring on the ground below each spot and a thin post up to its cameras; the spot pointed at is bright. Draws
/// the nearest kMaxMarks within 60 m, farthest first; marks fade out towards that distance and near the eye. `head`:
/// in tracking space.
void addMarks(Shapes& shapes, const Spots& spots, const Tracking& tracking, const Pose& head,
              double photographHeightMetres, std::optional<std::size_t> pointed);

/// Adds a small wand that points along −z.
void addHand(Shapes& shapes, const Pose& aim);

/// Adds a thin band of `metres` along the hand's −z that faces the head: bright with a target, else fading out towards
/// its end.
void addRay(Shapes& shapes, const Pose& head, const Pose& aim, double metres, bool hasTarget);

/// Returns the length of a ray that points at a spot, metres: to its mark on the ground or to its cameras, whichever is
/// closer to the ray in angle.
double rayLength(const Spot& spot, const Tracking& tracking, const Pose& aim, double photographHeightMetres);

/// Adds black over any field of view; strength 0 adds nothing.
void addFade(Shapes& shapes, double strength);

/// Adds black around a clear middle with a smooth rim; strength 0 adds nothing, 1 leaves 20° in each direction.
void addVignette(Shapes& shapes, double strength);

/// Adds a grid on the floor around the head, shown while a scene is loading.
void addFloorGrid(Shapes& shapes, const Pose& head);

/// Adds a ring in front of the user, 1 m above the floor, that fills clockwise from its top with `progress` (0 to 1).
/// nullopt: an arc rotates with time.
void addProgressRing(Shapes& shapes, const Pose& head, std::optional<double> progress, double seconds);

}  // namespace ibr::app
