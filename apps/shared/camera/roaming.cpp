// SPDX-License-Identifier: Apache-2.0
#include "shared/camera/roaming.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <set>

#include "shared/report/statistics.h"

namespace ibr::app {
namespace {

using Neighbours = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kMaxSampledCameras = 500;  // maximum number of cameras that neighbourDistance samples
constexpr double kRadiansPerStep = 0.5;
constexpr double kStepsPerSecond = 2, kExtentShare = 0.05;

glm::dvec3 nearestOn(glm::dvec3 a, glm::dvec3 b, glm::dvec3 p) {
  const glm::dvec3 line = b - a;
  const double square = glm::dot(line, line);
  return square > 0 ? a + std::clamp(glm::dot(p - a, line) / square, 0.0, 1.0) * line : a;
}

glm::dvec3 nearestPoint(const RoamingBounds& bounds, glm::dvec3 p) {
  glm::dvec3 nearest(kInfinity);
  double least = kInfinity;
  const auto offer = [&](glm::dvec3 candidate) {
    const double distance = glm::distance(candidate, p);
    if (distance < least) {
      least = distance;
      nearest = candidate;
    }
  };
  for (const glm::dvec3& place : bounds.positions) offer(place);
  for (const auto& [a, b] : bounds.neighbours) offer(nearestOn(bounds.positions[a], bounds.positions[b], p));
  return nearest;
}

double largestCoordinate(const std::vector<Pose>& cameras) {
  double largest = 0;
  for (const Pose& camera : cameras)
    for (int axis = 0; axis < 3; ++axis) largest = std::max(largest, std::abs(camera.position[axis]));
  return largest;
}

// Positions closer than this differ by rounding alone and count as equal.
double samePositionTolerance(const std::vector<Pose>& cameras) {
  return 1e-12 * largestCoordinate(cameras);
}

}  // namespace

Neighbours cellNeighbours(const Scene& scene) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> lines;
  for (const Cell& cell : scene.cells)
    for (const std::uint32_t a : cell.members)
      for (const std::uint32_t b : cell.members)
        if (a < b) lines.emplace(a, b);
  return {lines.begin(), lines.end()};
}

Neighbours nearNeighbours(const std::vector<Pose>& cameras, std::size_t count) {
  const double same = samePositionTolerance(cameras);
  std::set<std::pair<std::uint32_t, std::uint32_t>> lines;
  for (std::uint32_t a = 0; a < cameras.size(); ++a) {
    std::vector<std::pair<double, std::uint32_t>> others;
    for (std::uint32_t b = 0; b < cameras.size(); ++b)
      if (const double distance = glm::distance(cameras[a].position, cameras[b].position); distance > same)
        others.emplace_back(distance, b);
    const std::size_t kept = std::min(count, others.size());
    std::partial_sort(others.begin(), others.begin() + std::ptrdiff_t(kept), others.end());
    for (std::size_t i = 0; i < kept; ++i) lines.insert(std::minmax(a, others[i].second));
  }
  return {lines.begin(), lines.end()};
}

double distanceTo(const RoamingBounds& bounds, glm::dvec3 position) {
  return bounds.positions.empty() ? kInfinity : glm::distance(nearestPoint(bounds, position), position);
}

glm::dvec3 clampedToBounds(const RoamingBounds& bounds, glm::dvec3 from, glm::dvec3 to) {
  if (bounds.positions.empty()) return to;
  const glm::dvec3 nearest = nearestPoint(bounds, to);
  const double distance = glm::distance(nearest, to);
  if (distance <= bounds.radius) return to;
  const double limit = std::max(bounds.radius, distanceTo(bounds, from));
  return distance <= limit ? to : nearest + (to - nearest) * (limit / distance);
}

std::optional<double> neighbourDistance(const std::vector<Pose>& cameras) {
  const double same = samePositionTolerance(cameras);
  const std::size_t sampled = std::min(cameras.size(), kMaxSampledCameras);
  std::vector<double> distances;
  for (std::size_t i = 0; i < sampled; ++i) {
    const Pose& camera = cameras[i * cameras.size() / sampled];
    double least = kInfinity;
    for (const Pose& other : cameras)
      if (const double distance = glm::distance(camera.position, other.position); distance > same)
        least = std::min(least, distance);
    if (std::isfinite(least)) distances.push_back(least);
  }
  if (distances.empty()) return std::nullopt;
  return quantile(distances, 0.5);
}

double initialSpeed(const std::vector<Pose>& cameras) {
  const auto step = neighbourDistance(cameras);
  if (!step) return 1;
  glm::dvec3 low(kInfinity), high(-kInfinity);
  for (const Pose& camera : cameras) {
    low = glm::min(low, camera.position);
    high = glm::max(high, camera.position);
  }
  return std::max(kStepsPerSecond * *step, kExtentShare * glm::distance(low, high));
}

std::optional<std::size_t> nearestCamera(const std::vector<Pose>& cameras, const Pose& pose) {
  if (cameras.empty()) return std::nullopt;
  const double step = neighbourDistance(cameras).value_or(1);
  const auto cost = [&](const Pose& camera) {
    return glm::distance(camera.position, pose.position) / step +
           angleBetween(camera.rotation, pose.rotation) / kRadiansPerStep;
  };
  const auto nearest = std::ranges::min_element(cameras, {}, cost);
  return std::size_t(nearest - cameras.begin());
}

std::optional<std::size_t> nextCamera(const std::vector<Pose>& cameras, const Pose& pose, int steps) {
  const auto nearest = nearestCamera(cameras, pose);
  if (!nearest || steps == 0) return nearest;
  const double same = 1e-9 * std::max(1.0, largestCoordinate(cameras));
  const auto isThere = [&](std::size_t camera) {
    return glm::distance(cameras[camera].position, pose.position) <= same &&
           angleBetween(cameras[camera].rotation, pose.rotation) <= 1e-6;
  };
  const std::size_t count = cameras.size(), one = steps > 0 ? 1 : count - 1;
  std::size_t camera = *nearest;
  for (int left = std::abs(steps) - (isThere(camera) ? 0 : 1); left > 0; --left) {
    camera = (camera + one) % count;
    for (std::size_t tried = 1; tried < count && isThere(camera); ++tried) camera = (camera + one) % count;
  }
  return camera;
}

}  // namespace ibr::app
