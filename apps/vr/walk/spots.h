// SPDX-License-Identifier: Apache-2.0
// Places where photographs were taken, to stand at.
#pragma once

#include <optional>
#include <vector>

#include "vr/walk/tracking.h"

namespace ibr::app {

/// Photographs that share a place: a panorama that was split, a bracket of exposures, or just one.
struct Spot {
  glm::dvec3 position{0.0};           // world, the middle of its photographs
  glm::dvec3 facing{0.0, 0.0, -1.0};  // unit, horizontal: the mean of where they look; all around: where the first does
  std::vector<std::uint32_t> nodes;   // indices of the cameras, ascending; at least one
};

/// The spots of cameras, in the order of their first camera. Cameras share a place when they are nearer to each other
/// than a twentieth of the usual distance between places, or where distances are plainly of two kinds, one a hundred
/// times the other and both of them frequent, as they are between brackets and between places. `up` is unit.
std::vector<Spot> spotsOf(const std::vector<Pose>& cameras, glm::dvec3 up);

/// The ground below a spot, where photographs are `photographHeight` (world units) above it.
glm::dvec3 groundOf(const Spot& spot, glm::dvec3 up, double photographHeight);

/// The head comes to stand at the spot, its photographs `photographHeightMetres` above the real floor: a tall person's
/// eyes are above them, as they would be there. Faces as before, or along `facing` (world) as far as it is horizontal:
/// at the first start a spot's own.
Tracking standAt(const Tracking& now, const Pose& head, const Spot& spot, double photographHeightMetres,
                 std::optional<glm::dvec3> facing = std::nullopt);

/// World; the direction of any length above 0.
struct Ray {
  glm::dvec3 origin{0.0}, direction{0.0, 0.0, -1.0};
};

/// What a hand points with: along its −z.
Ray rayOf(const Pose& aim);

struct PointingSettings {
  double cone = 0.105;       // radians about the ray, 6°
  double tie = 0.0087;       // radians: of those as near as this to the best, the one least far away is meant
  double hold = 0.0175;      // radians: what is held is left only for one that is nearer to the ray by more
  double leastDistance = 0;  // world units: marks and photographs nearer to the hand are not pointed at
};

/// The spot that a ray points at, by its mark on the ground or by its photographs' place, whichever is nearer to the
/// ray in angle; `held`: the one pointed at until now. nullopt: none within the cone, or a ray that is not finite.
std::optional<std::size_t> pointedSpot(const std::vector<Spot>& spots, const Ray& ray, glm::dvec3 up,
                                       double photographHeight, std::optional<std::size_t> held = std::nullopt,
                                       const PointingSettings& settings = {});

/// The spot that is nearest horizontally; nullopt of none.
std::optional<std::size_t> nearestSpot(const std::vector<Spot>& spots, glm::dvec3 position, glm::dvec3 up);

/// A map seen from above: x to the right, y down, both 0 to 1, one scale for both.
struct SpotMap {
  glm::dvec3 middle{0.0};                    // world, at (0.5, 0.5)
  glm::dvec3 right{1, 0, 0}, down{0, 0, 1};  // unit, horizontal: the world's x axis, or y where x is up
  double side = 1;                           // world units from edge to edge, > 0
  std::vector<glm::dvec2> places;            // of the spots
};

/// All spots with a margin around them.
SpotMap mapOf(const std::vector<Spot>& spots, glm::dvec3 up);

/// A point of the world on the map, held at its edge.
glm::dvec2 onMap(const SpotMap& map, glm::dvec3 position);

/// A horizontal direction on the map, unit; (0, 0) where there is none.
glm::dvec2 directionOnMap(const SpotMap& map, glm::dvec3 direction);

}  // namespace ibr::app
