// SPDX-License-Identifier: Apache-2.0
// How far from the photographs a camera may go, and which of them is near.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "ibr/camera.h"
#include "ibr/scene.h"

namespace ibr::app {

/// All that is within `radius` of a photograph's place, or of the line between two neighbours'.
struct RoamingBounds {
  std::vector<glm::dvec3> places;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> neighbours;  // of places
  double radius = 0;                                                // world units, > 0
};

/// The lines of a scene's cells, each once.
std::vector<std::pair<std::uint32_t, std::uint32_t>> cellNeighbours(const Scene& scene);

/// From each camera to its `count` nearest, each once: for what has no cells. Cameras at one place are no neighbours.
std::vector<std::pair<std::uint32_t, std::uint32_t>> nearNeighbours(const std::vector<Pose>& cameras,
                                                                    std::size_t count);

/// World units to the nearest place or line; infinite where there is none.
double distanceTo(const RoamingBounds& bounds, glm::dvec3 position);

/// Where a camera comes to that goes from one position to another. What leads out ends on the boundary, at the point
/// that is nearest; a camera that is outside already gets no further away, and never leaps back. Without places: `to`.
glm::dvec3 keptWithin(const RoamingBounds& bounds, glm::dvec3 from, glm::dvec3 to);

/// The median of the distances from a camera to the nearest that is at another place; nullopt where all are at one. Of
/// many cameras, some are asked.
std::optional<double> neighbourDistance(const std::vector<Pose>& cameras);

/// World units a second to begin with, from the scene's size: two steps between neighbours, at least a twentieth of
/// what the cameras span; 1 where that is nothing.
double firstSpeed(const std::vector<Pose>& cameras);

/// The camera that shows most nearly what `pose` does: half a radian off counts as a step between neighbours does.
/// nullopt of none.
std::optional<std::size_t> nearestCamera(const std::vector<Pose>& cameras, const Pose& pose);

/// The camera `steps` after the nearest (before: < 0) in their order, round the ends; nullopt of none. One that is not
/// where `pose` is counts as the first step, and those that see the same as `pose` are passed over.
std::optional<std::size_t> nextCamera(const std::vector<Pose>& cameras, const Pose& pose, int steps);

}  // namespace ibr::app
