// SPDX-License-Identifier: Apache-2.0
// The little that is drawn besides the place: marks of spots, hands, fades, a floor while loading. Coloured triangles,
// three vertices each, both sides seen, in the order in which they are blended.
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
  std::vector<ShapeVertex> inSpace;  // tracking space, metres, tested against the place's depth
  std::vector<ShapeVertex> onView;   // each eye's axes at z = −1: x and y are tangents; over everything
};

inline constexpr std::size_t kMostMarks = 500;

/// A ring on the ground below each spot and a thin post up to its photographs' place; the one pointed at is bright.
/// The nearest kMostMarks within 60 m, farthest first; they fade towards that distance and near the eye. `head` is
/// in tracking space.
void addMarks(Shapes& shapes, const std::vector<Spot>& spots, const Tracking& tracking, const Pose& head,
              double photographHeightMetres, std::optional<std::size_t> pointed);

/// A small wand that points along −z.
void addHand(Shapes& shapes, const Pose& aim);

/// A thin band from a hand along its −z that faces the head, `metres` long; bright where it has a target. It fades
/// towards its end where it has none.
void addRay(Shapes& shapes, const Pose& head, const Pose& aim, double metres, bool hasTarget);

/// How long a ray is that points at a spot, metres: to its mark or its photographs' place, whichever is nearer to the
/// ray in angle.
double rayLength(const Spot& spot, const Tracking& tracking, const Pose& aim, double photographHeightMetres);

/// Black over all of any field of view; strength 0 adds nothing.
void addFade(Shapes& shapes, double strength);

/// Black around a clear middle with a smooth rim; 0 adds nothing, 1 leaves 20° each way.
void addVignette(Shapes& shapes, double strength);

/// A grid on the floor about the head, for while nothing else is there.
void addFloorGrid(Shapes& shapes, const Pose& head);

/// A ring before the head's feet and a little up that fills clockwise from its top with `progress` (0 to 1); unknown:
/// a piece of it goes round with the time.
void addProgressRing(Shapes& shapes, const Pose& head, std::optional<double> progress, double seconds);

}  // namespace ibr::app
