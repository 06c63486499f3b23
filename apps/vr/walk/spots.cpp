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
constexpr double kMargin = 1e-9;     // of lower bounds, for rounding: radians, or relative to distances
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

// Returns a lower bound of angleTo for all points of a box that is moved by `offset`.
double angleTo(const Ray& ray, glm::dvec3 direction, const Box& box, glm::dvec3 offset) {
  const glm::dvec3 to = 0.5 * (box.low + box.high) + offset - ray.origin;
  const double distance = glm::length(to), radius = 0.5 * glm::length(box.high - box.low) + kMargin * distance;
  if (!(distance > radius)) return 0;
  return std::max(0.0, std::atan2(glm::length(glm::cross(direction, to)), glm::dot(direction, to)) -
                           std::asin(radius / distance) - kMargin);
}

void count(std::size_t* compared) {
  if (compared) ++*compared;
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

Spots::Spots(std::vector<Spot> spots) : spots_(std::move(spots)) {
  std::vector<std::uint32_t> finite;
  for (std::uint32_t i = 0; i < spots_.size(); ++i)
    if (isFinite(spots_[i].position)) finite.push_back(i);
  tree_ = makeBoxTree(std::move(finite), [this](std::uint32_t i) {
    return Box{spots_[i].position, spots_[i].position};
  });
}

std::optional<std::size_t> pointedSpot(const Spots& spots, const Ray& ray, glm::dvec3 up, double photographHeight,
                                       std::optional<std::size_t> held, const PointingSettings& settings,
                                       std::size_t* compared) {
  const double length = glm::length(ray.direction);
  if (!isFinite(ray.origin) || !std::isfinite(length) || !(length > 0)) return std::nullopt;
  const glm::dvec3 direction = ray.direction / length;
  const auto angle = [&](const Spot& spot) {
    return std::min(angleTo(ray, direction, spot.position, settings.minDistance),
                    angleTo(ray, direction, groundOf(spot, up, photographHeight), settings.minDistance));
  };
  const auto boxAngle = [&](const Box& box) {
    return std::min(angleTo(ray, direction, box, glm::dvec3(0)), angleTo(ray, direction, box, -photographHeight * up));
  };
  double best = settings.cone;  // angles beyond the cone decide nothing
  searchBoxes(spots.tree(), best, boxAngle, [&](std::uint32_t i) {
    count(compared);
    return best = std::min(best, angle(spots[i]));
  });
  if (held && *held < spots.size())
    if (const double now = angle(spots[*held]); now <= settings.cone + settings.hold && now <= best + settings.hold)
      return held;
  std::optional<std::size_t> nearest;
  double least = std::numeric_limits<double>::infinity();
  const double maxAngle = std::min(best + settings.tie, settings.cone);
  const auto boxDistance = [&](const Box& box) {
    return boxAngle(box) > maxAngle ? std::numeric_limits<double>::infinity()
                                    : (1 - kMargin) * distanceToBox(box, ray.origin);
  };
  searchBoxes(spots.tree(), std::numeric_limits<double>::max(), boxDistance, [&](std::uint32_t i) {
    count(compared);
    const double distance = glm::distance(spots[i].position, ray.origin);
    if ((distance < least || (distance == least && i < *nearest)) && angle(spots[i]) <= maxAngle) {
      least = distance;
      nearest = i;
    }
    return std::min(least, std::numeric_limits<double>::max());
  });
  return nearest;
}

std::optional<std::size_t> nearestSpot(const Spots& spots, glm::dvec3 position, glm::dvec3 up, std::size_t* compared) {
  const auto boxDistance = [&](const Box& box) {
    const glm::dvec3 to = 0.5 * (box.low + box.high) - position;
    return (1 - kMargin) * (glm::length(level(to, up)) - 0.5 * glm::length(box.high - box.low)) -
           kMargin * glm::length(to);
  };
  std::optional<std::size_t> nearest;
  double least = std::numeric_limits<double>::infinity();
  searchBoxes(spots.tree(), least, boxDistance, [&](std::uint32_t i) {
    count(compared);
    const double distance = glm::length(level(spots[i].position - position, up));
    if (!nearest || distance < least || (distance == least && i < *nearest)) {
      least = distance;
      nearest = i;
    }
    return least;
  });
  return nearest;
}

std::size_t nearestSpots(const Spots& spots, glm::dvec3 position, double maxDistance, std::span<SpotDistance> found,
                         std::size_t* compared) {
  if (found.empty()) return 0;
  std::size_t number = 0;  // of spots in `found`, a heap with the farthest first
  const auto boxDistance = [&](const Box& box) { return (1 - kMargin) * distanceToBox(box, position); };
  searchBoxes(spots.tree(), maxDistance, boxDistance, [&](std::uint32_t i) {
    count(compared);
    const SpotDistance here{glm::distance(spots[i].position, position), i};
    const auto end = [&] { return found.begin() + std::ptrdiff_t(number); };
    if (here.distance < maxDistance && number < found.size()) {
      found[number++] = here;
      std::push_heap(found.begin(), end());
    } else if (number == found.size() && here < found.front()) {
      std::pop_heap(found.begin(), end());
      found.back() = here;
      std::push_heap(found.begin(), end());
    }
    return number == found.size() ? found.front().distance : maxDistance;
  });
  std::sort_heap(found.begin(), found.begin() + std::ptrdiff_t(number));
  return number;
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
