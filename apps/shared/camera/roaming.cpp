// SPDX-License-Identifier: Apache-2.0
#include "shared/camera/roaming.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <set>
#include <tuple>

#include "shared/report/statistics.h"

namespace ibr::app {
namespace {

using Neighbours = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kMaxSampledCameras = 500;  // maximum number of cameras that neighbourDistance samples
constexpr double kRadiansPerStep = 0.5;
constexpr double kRounding = 1e-14;  // relative to coordinates: points on lines are less inexact
constexpr double kMargin = 1e-12;    // relative to distances, which are less inexact
constexpr double kStepsPerSecond = 2, kExtentShare = 0.05;

glm::dvec3 nearestOn(glm::dvec3 a, glm::dvec3 b, glm::dvec3 p) {
  const glm::dvec3 line = b - a;
  const double square = glm::dot(line, line);
  return square > 0 ? a + std::clamp(glm::dot(p - a, line) / square, 0.0, 1.0) * line : a;
}

// A point of `positions`, or a line after all points.
glm::dvec3 nearestOn(const RoamingBounds& bounds, std::uint32_t item, glm::dvec3 p) {
  if (item < bounds.positions.size()) return bounds.positions[item];
  const auto& [a, b] = bounds.neighbours[item - bounds.positions.size()];
  return nearestOn(bounds.positions[a], bounds.positions[b], p);
}

// Returns a box that holds each result of nearestOn, rounding included.
Box boxOf(const RoamingBounds& bounds, std::uint32_t item) {
  if (item < bounds.positions.size()) return {bounds.positions[item], bounds.positions[item]};
  const auto& [a, b] = bounds.neighbours[item - bounds.positions.size()];
  const glm::dvec3 p = bounds.positions[a], q = bounds.positions[b];
  const glm::dvec3 rounding = kRounding * glm::max(glm::abs(p), glm::abs(q));
  return {glm::min(p, q) - rounding, glm::max(p, q) + rounding};
}

bool isFinite(glm::dvec3 v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// Returns for each position the first one with the same coordinates; nullopt for one that is not finite.
std::vector<std::optional<std::uint32_t>> firstsOf(const std::vector<glm::dvec3>& positions) {
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < positions.size(); ++i)
    if (isFinite(positions[i])) order.push_back(i);
  const auto key = [&](std::uint32_t i) { return std::tuple(positions[i].x, positions[i].y, positions[i].z, i); };
  std::ranges::sort(order, {}, key);
  std::vector<std::optional<std::uint32_t>> firsts(positions.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && positions[order[i]] == positions[order[i - 1]];
    firsts[order[i]] = same ? *firsts[order[i - 1]] : order[i];
  }
  return firsts;
}

// Returns positions and lines of which none is a copy of another: many copies would all be compared in each search.
std::vector<std::uint32_t> distinctItems(const RoamingBounds& bounds) {
  const auto firsts = firstsOf(bounds.positions);
  const std::uint32_t points = std::uint32_t(bounds.positions.size());
  std::vector<std::uint32_t> items;
  for (std::uint32_t i = 0; i < points; ++i)
    if (firsts[i] == i) items.push_back(i);
  std::vector<std::array<std::uint32_t, 3>> lines;  // ends, item
  for (std::uint32_t i = 0; i < bounds.neighbours.size(); ++i) {
    const auto a = firsts[bounds.neighbours[i].first], b = firsts[bounds.neighbours[i].second];
    if (a && b && a != b) lines.push_back({*a, *b, points + i});
  }
  std::ranges::sort(lines);
  const auto isCopy = [](const auto& one, const auto& other) { return one[0] == other[0] && one[1] == other[1]; };
  const auto copies = std::ranges::unique(lines, isCopy);
  lines.erase(copies.begin(), copies.end());
  for (const auto& line : lines) items.push_back(line[2]);
  return items;
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
  Neighbours lines;
  for (const Cell& cell : scene.cells)
    for (const std::uint32_t a : cell.members)
      for (const std::uint32_t b : cell.members)
        if (a < b) lines.emplace_back(a, b);
  std::ranges::sort(lines);
  const auto copies = std::ranges::unique(lines);
  lines.erase(copies.begin(), copies.end());
  return lines;
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

void addIndex(RoamingBounds& bounds) {
  bounds.index = makeBoxTree(distinctItems(bounds), [&](std::uint32_t item) { return boxOf(bounds, item); });
}

NearestPoint nearestPoint(const RoamingBounds& bounds, glm::dvec3 position) {
  NearestPoint nearest;
  std::uint32_t best = 0;
  const auto offer = [&](std::uint32_t item) {
    ++nearest.compared;
    const glm::dvec3 point = nearestOn(bounds, item, position);
    const double distance = glm::distance(point, position);
    if (distance < nearest.distance || (distance == nearest.distance && item < best)) {
      nearest.point = point;
      nearest.distance = distance;
      best = item;
    }
    return nearest.distance;
  };
  const std::size_t items = bounds.positions.size() + bounds.neighbours.size();
  for (std::uint32_t item = 0; bounds.index.nodes.empty() && item < items; ++item) offer(item);
  const auto bound = [&](const Box& box) { return (1 - kMargin) * distanceToBox(box, position); };
  searchBoxes(bounds.index, nearest.distance, bound, offer);
  return nearest;
}

double distanceTo(const RoamingBounds& bounds, glm::dvec3 position) {
  return nearestPoint(bounds, position).distance;
}

glm::dvec3 clampedToBounds(const RoamingBounds& bounds, glm::dvec3 from, glm::dvec3 to) {
  if (bounds.positions.empty()) return to;
  const NearestPoint nearest = nearestPoint(bounds, to);
  if (nearest.distance <= bounds.radius) return to;
  const double limit = std::max(bounds.radius, distanceTo(bounds, from));
  return nearest.distance <= limit ? to : nearest.point + (to - nearest.point) * (limit / nearest.distance);
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
