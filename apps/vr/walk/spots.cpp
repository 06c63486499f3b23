// SPDX-License-Identifier: Apache-2.0
#include "vr/walk/spots.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>

#include "shared/camera/roaming.h"
#include "vr/walk/groups.h"

namespace ibr::app {
namespace {

constexpr double kAllAround = 0.3;   // min. length of a mean direction; below, the spot looks all around
constexpr double kMapMargin = 0.08;  // at each edge, share of the map's side

Spot spotOf(const std::vector<Pose>& cameras, std::vector<std::uint32_t> nodes, glm::dvec3 up) {
  const Pose& first = cameras[nodes.front()];
  glm::dvec3 offset(0), facing(0);
  for (const std::uint32_t node : nodes) {
    offset += cameras[node].position - first.position;
    facing += facingOf(cameras[node].rotation, up);
  }
  const double count = double(nodes.size());
  const bool around = !(glm::length(facing) > kAllAround * count);
  return {first.position + offset / count, around ? facingOf(first.rotation, up) : glm::normalize(facing),
          std::move(nodes)};
}

// Returns π for points that are not finite or not farther than minDistance.
double angleTo(const Ray& ray, glm::dvec3 direction, glm::dvec3 point, double minDistance) {
  const glm::dvec3 to = point - ray.origin;
  const double distance = glm::length(to);
  if (!(distance > minDistance)) return glm::pi<double>();
  return std::atan2(glm::length(glm::cross(direction, to)), glm::dot(direction, to));
}

bool isFinite(glm::dvec3 v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

glm::dvec3 level(glm::dvec3 v, glm::dvec3 up) {
  return v - glm::dot(v, up) * up;
}

}  // namespace

std::vector<Spot> spotsOf(const std::vector<Pose>& cameras, glm::dvec3 up) {
  std::vector<glm::dvec3> places;
  for (const Pose& camera : cameras) places.push_back(camera.position);
  std::vector<Spot> spots;
  for (std::vector<std::uint32_t>& nodes : groupsOf(places)) spots.push_back(spotOf(cameras, std::move(nodes), up));
  return spots;
}

glm::dvec3 groundOf(const Spot& spot, glm::dvec3 up, double photographHeight) {
  return spot.position - photographHeight * up;
}

Tracking standAt(const Tracking& now, const Pose& head, const Spot& spot, double photographHeightMetres,
                 std::optional<glm::dvec3> facing) {
  const Tracking faced = facing ? turnedTo(now, head, *facing) : now;
  return stoodOn(faced, head, groundOf(spot, upInWorld(faced), photographHeightMetres * faced.unitsPerMetre));
}

Ray rayOf(const Pose& aim) {
  return {aim.position, viewAxis(aim)};
}

std::optional<std::size_t> pointedSpot(const std::vector<Spot>& spots, const Ray& ray, glm::dvec3 up,
                                       double photographHeight, std::optional<std::size_t> held,
                                       const PointingSettings& settings) {
  const double length = glm::length(ray.direction);
  if (!isFinite(ray.origin) || !std::isfinite(length) || !(length > 0)) return std::nullopt;
  const glm::dvec3 direction = ray.direction / length;
  const auto angle = [&](const Spot& spot) {
    return std::min(angleTo(ray, direction, spot.position, settings.minDistance),
                    angleTo(ray, direction, groundOf(spot, up, photographHeight), settings.minDistance));
  };
  std::vector<double> angles(spots.size());
  std::ranges::transform(spots, angles.begin(), angle);
  const auto best = std::ranges::min_element(angles);
  if (best == angles.end()) return std::nullopt;
  if (held && *held < spots.size() && angles[*held] <= settings.cone + settings.hold &&
      angles[*held] <= *best + settings.hold)
    return held;
  std::optional<std::size_t> nearest;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < spots.size(); ++i)
    if (const double distance = glm::distance(spots[i].position, ray.origin);
        angles[i] <= std::min(*best + settings.tie, settings.cone) && distance < least) {
      least = distance;
      nearest = i;
    }
  return nearest;
}

std::optional<std::size_t> nearestSpot(const std::vector<Spot>& spots, glm::dvec3 position, glm::dvec3 up) {
  if (spots.empty()) return std::nullopt;
  const auto nearest = std::ranges::min_element(
      spots, {}, [&](const Spot& spot) { return glm::length(level(spot.position - position, up)); });
  return std::size_t(nearest - spots.begin());
}

SpotMap mapOf(const std::vector<Spot>& spots, glm::dvec3 up) {
  SpotMap map;
  const glm::dvec3 x = level({1, 0, 0}, up), y = level({0, 1, 0}, up);
  map.right = glm::normalize(glm::length(x) > 0.1 ? x : y);
  map.down = glm::cross(map.right, up);
  if (spots.empty()) return map;
  const glm::dvec3 from = spots.front().position;
  glm::dvec2 low(0), high(0);
  for (const Spot& spot : spots) {
    const glm::dvec2 at(glm::dot(spot.position - from, map.right), glm::dot(spot.position - from, map.down));
    low = glm::min(low, at);
    high = glm::max(high, at);
  }
  const glm::dvec2 span = high - low, middle = 0.5 * (low + high);
  map.middle = from + middle.x * map.right + middle.y * map.down;
  const double most = std::max(span.x, span.y);
  map.side = most > 0 ? most / (1 - 2 * kMapMargin) : 1;
  for (const Spot& spot : spots) map.places.push_back(onMap(map, spot.position));
  return map;
}

glm::dvec2 onMap(const SpotMap& map, glm::dvec3 position) {
  const glm::dvec3 from = position - map.middle;
  const glm::dvec2 at = 0.5 + glm::dvec2(glm::dot(from, map.right), glm::dot(from, map.down)) / map.side;
  return glm::clamp(at, 0.0, 1.0);
}

glm::dvec2 directionOnMap(const SpotMap& map, glm::dvec3 direction) {
  const glm::dvec2 on(glm::dot(direction, map.right), glm::dot(direction, map.down));
  const double length = glm::length(on);
  return length > 1e-6 * glm::length(direction) ? on / length : glm::dvec2(0);
}

}  // namespace ibr::app
