// SPDX-License-Identifier: Apache-2.0
// Limits of the distance between the camera and the photographs, and the search for near photographs.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "ibr/camera.h"
#include "ibr/scene.h"
#include "shared/camera/box_tree.h"

namespace ibr::app {

/// All points within `radius` of a photograph's position, or of the line between two neighbours.
struct RoamingBounds {
  std::vector<glm::dvec3> positions;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> neighbours;  // indices into positions
  double radius = 0;                                                // world units, > 0
  BoxTree index = {};  // of positions and neighbours, by addIndex(); empty: searches compare all of them
};

/// Call once when positions and neighbours are complete; they must not change afterwards. Frames need the index: their
/// searches then hardly depend on the size of the scene. Results stay the same.
void addIndex(RoamingBounds& bounds);

struct NearestPoint {
  glm::dvec3 point{std::numeric_limits<double>::infinity()};
  double distance = std::numeric_limits<double>::infinity();  // world units
  std::size_t compared = 0;                                   // number of positions and lines that the search compared
};

/// Returns the nearest point of all positions and lines, the first of equally near ones; infinite if there is none.
NearestPoint nearestPoint(const RoamingBounds& bounds, glm::dvec3 position);

/// Returns the edges between the members of a scene's cells, each once.
std::vector<std::pair<std::uint32_t, std::uint32_t>> cellNeighbours(const Scene& scene);

/// Returns pairs of each camera and its `count` nearest at other positions, each pair once; for models without cells.
std::vector<std::pair<std::uint32_t, std::uint32_t>> nearNeighbours(const std::vector<Pose>& cameras,
                                                                    std::size_t count);

/// Returns the distance to the nearest position or line, world units; infinite if there is none.
double distanceTo(const RoamingBounds& bounds, glm::dvec3 position);

/// Returns the end of a motion from `from` to `to`, limited to the bounds. A motion out of them ends at the nearest
/// point of the boundary. A camera that is already outside gets no farther away. Without positions: `to`.
glm::dvec3 clampedToBounds(const RoamingBounds& bounds, glm::dvec3 from, glm::dvec3 to);

/// Returns the median distance from a camera to the nearest camera at another position; nullopt if all are at one. At
/// most 500 cameras are sampled.
std::optional<double> neighbourDistance(const std::vector<Pose>& cameras);

/// Returns an initial speed, world units a second: two distances between neighbours, at least a twentieth of the
/// cameras' extent; 1 if all cameras share a position.
double initialSpeed(const std::vector<Pose>& cameras);

/// Returns the camera with the view nearest to `pose`: half a radian counts as much as the distance between neighbours.
/// nullopt: there are no cameras.
std::optional<std::size_t> nearestCamera(const std::vector<Pose>& cameras, const Pose& pose);

/// Returns the camera `steps` after the nearest one (negative: before) in their order, cyclic; nullopt: none. Going to
/// the nearest camera counts as the first step unless `pose` is there. Cameras with the view of `pose` are skipped.
std::optional<std::size_t> nextCamera(const std::vector<Pose>& cameras, const Pose& pose, int steps);

}  // namespace ibr::app
