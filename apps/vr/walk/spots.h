// SPDX-License-Identifier: Apache-2.0
// Spots: capture sites to stand at.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "shared/camera/box_tree.h"
#include "vr/walk/tracking.h"

namespace ibr::app {

/// Photographs of one capture site: a split panorama, an exposure bracket, or a single photograph.
struct Spot {
  glm::dvec3 position{0.0};           // world, mean of its cameras
  glm::dvec3 facing{0.0, 0.0, -1.0};  // unit, horizontal: mean viewing direction; if all around: the first camera's
  std::vector<std::uint32_t> nodes;   // indices of cameras, ascending; at least one
};

/// Returns the spots of cameras, in the order of their first camera. Cameras share a spot if closer than a twentieth of
/// the median distance between spots. They also do if distances are clearly of two kinds, both frequent and a factor of
/// 100 apart, as with exposure brackets. `up` is unit.
std::vector<Spot> spotsOf(const std::vector<Pose>& cameras, glm::dvec3 up);

/// All spots of a scene, and a tree over their positions: searches hardly depend on the number of spots. Searches
/// ignore spots that are not finite.
class Spots {
 public:
  Spots() = default;
  explicit Spots(std::vector<Spot> spots);

  bool empty() const noexcept { return spots_.empty(); }
  std::size_t size() const noexcept { return spots_.size(); }
  const Spot& operator[](std::size_t spot) const noexcept { return spots_[spot]; }
  const std::vector<Spot>& all() const noexcept { return spots_; }
  const BoxTree& tree() const noexcept { return tree_; }  // of the spots' positions

 private:
  std::vector<Spot> spots_;
  BoxTree tree_;
};

/// Ground below a spot; its cameras are `photographHeight` (world units) above the ground.
glm::dvec3 groundOf(const Spot& spot, glm::dvec3 up, double photographHeight);

/// Puts the head over the spot, so that the spot's cameras are `photographHeightMetres` above the real floor: a tall
/// user's eyes are above the cameras. Keeps the facing, or turns to the horizontal part of `facing` (world), such as a
/// spot's own at the start.
Tracking standAt(const Tracking& now, const Pose& head, const Spot& spot, double photographHeightMetres,
                 std::optional<glm::dvec3> facing = std::nullopt);

/// In world coordinates; the direction may have any length above 0.
struct Ray {
  glm::dvec3 origin{0.0}, direction{0.0, 0.0, -1.0};
};

/// Ray of a hand, along its −z.
Ray rayOf(const Pose& aim);

struct PointingSettings {
  double cone = 0.105;     // radians around the ray, 6°
  double tie = 0.0087;     // radians: among spots this close to the best angle, the nearest spot wins
  double hold = 0.0175;    // radians: another spot must be closer to the ray by this to replace the current one
  double minDistance = 0;  // world units: nearer marks and cameras are ignored
};

/// Returns the spot that a ray points at: by its mark on the ground or its cameras, whichever is closer to the ray in
/// angle. `held`: the current spot. nullopt: none within the cone, or the ray is not finite. `compared`: increased by
/// the number of spots that the search compared.
std::optional<std::size_t> pointedSpot(const Spots& spots, const Ray& ray, glm::dvec3 up, double photographHeight,
                                       std::optional<std::size_t> held = std::nullopt,
                                       const PointingSettings& settings = {}, std::size_t* compared = nullptr);

/// Returns the horizontally nearest spot; nullopt if there are none.
std::optional<std::size_t> nearestSpot(const Spots& spots, glm::dvec3 position, glm::dvec3 up,
                                       std::size_t* compared = nullptr);

struct SpotDistance {
  double distance = 0;  // world units
  std::uint32_t spot = 0;
  auto operator<=>(const SpotDistance&) const = default;
};

/// Finds the spots nearest to a position, closer than `maxDistance` (world units). Writes at most found.size() of them,
/// nearest first, and returns their number.
std::size_t nearestSpots(const Spots& spots, glm::dvec3 position, double maxDistance, std::span<SpotDistance> found,
                         std::size_t* compared = nullptr);

/// Map seen from above: x to the right, y down, both 0 to 1, with equal scale.
struct SpotMap {
  glm::dvec3 middle{0.0};                    // world, at (0.5, 0.5)
  glm::dvec3 right{1, 0, 0}, down{0, 0, 1};  // unit, horizontal: world x axis, or y where x is up
  double side = 1;                           // world units from edge to edge, > 0
  std::vector<glm::dvec2> places;            // of the spots
};

/// Returns a map of all spots, with a margin.
SpotMap mapOf(const std::vector<Spot>& spots, glm::dvec3 up);

/// Maps a world point, clamped to the map's edge.
glm::dvec2 onMap(const SpotMap& map, glm::dvec3 position);

/// Maps a direction to a unit direction on the map; (0, 0) if it has no horizontal part.
glm::dvec2 directionOnMap(const SpotMap& map, glm::dvec3 direction);

}  // namespace ibr::app
