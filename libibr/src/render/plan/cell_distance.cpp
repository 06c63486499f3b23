// SPDX-License-Identifier: Apache-2.0
#include "render/plan/cell_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <span>

namespace ibr {
namespace {

// Weights of the members sorted by position, so that their order in the cell does not matter.
Barycentric sortedWeights(const CellPoses& cell, glm::dvec3 position) {
  std::array<glm::dvec3, 4> corners;
  for (std::size_t i = 0; i < cell.count; ++i) corners[i] = cell.pose[cell.byPosition[i]].position;
  return barycentric(std::span(corners.data(), cell.count), position);
}

Barycentric inMemberOrder(const CellPoses& cell, const Barycentric& sorted) {
  Barycentric result = sorted;
  for (std::size_t i = 0; i < cell.count; ++i) {
    result.free[cell.byPosition[i]] = sorted.free[i];
    result.clamped[cell.byPosition[i]] = sorted.clamped[i];
  }
  return result;
}

}  // namespace

double largestCoordinate(glm::dvec3 v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

CellDistance cellDistance(const CellPoses& cell, double size, const Pose& view) {
  const Barycentric sorted = sortedWeights(cell, view.position);
  CellDistance result;
  result.weights = inMemberOrder(cell, sorted);
  const glm::dvec3 forward = viewAxis(view);
  glm::dvec3 axis(0.0);  // a panorama counts as looking along the view's axis
  bool anyPinhole = false;
  double magnitude = largestCoordinate(view.position);
  for (std::size_t i = 0; i < cell.count; ++i) {
    const std::size_t member = cell.byPosition[i];
    const Pose& pose = cell.pose[member];
    axis += sorted.clamped[i] * (cell.isPanorama(member) ? forward : viewAxis(pose));
    anyPinhole |= !cell.isPanorama(member);
    magnitude = std::max(magnitude, largestCoordinate(pose.position));
  }
  // Positions are rounded at the scale of the world, differences at the scale of the cell.
  const double tolerance = std::max(1e-9 * size, 8.0 * std::numeric_limits<double>::epsilon() * magnitude);
  result.extrapolation = sorted.distance <= tolerance ? 0.0 : sorted.distance;
  // atan2 is precise at small angles, acos is not.
  if (anyPinhole) result.rotation = std::atan2(glm::length(glm::cross(axis, forward)), glm::dot(axis, forward));
  return result;
}

Barycentric cellWeights(const CellPoses& cell, glm::dvec3 position) {
  return inMemberOrder(cell, sortedWeights(cell, position));
}

}  // namespace ibr
