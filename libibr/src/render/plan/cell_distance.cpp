// SPDX-License-Identifier: Apache-2.0
#include "render/plan/cell_distance.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

namespace ibr {
namespace {

bool before(glm::dvec3 a, glm::dvec3 b) {
  if (a.x != b.x) return a.x < b.x;
  if (a.y != b.y) return a.y < b.y;
  return a.z < b.z;
}

// Weights of the members sorted by position, so that their order in the cell does not matter.
struct Sorted {
  std::array<std::size_t, 4> order{0, 1, 2, 3};
  Barycentric weights;
};

Sorted sortedWeights(const Scene& scene, const Cell& cell, glm::dvec3 position) {
  const std::size_t d = cell.members.size();
  Sorted sorted;
  std::array<std::size_t, 4>& order = sorted.order;
  const auto memberPosition = [&](std::size_t member) {
    return scene.nodes[cell.members[member]].camera.pose.position;
  };
  for (std::size_t i = 1; i < d; ++i)
    for (std::size_t j = i; j > 0 && before(memberPosition(order[j]), memberPosition(order[j - 1])); --j)
      std::swap(order[j], order[j - 1]);
  std::array<glm::dvec3, 4> corners;
  for (std::size_t i = 0; i < d; ++i) corners[i] = memberPosition(order[i]);
  sorted.weights = barycentric(std::span(corners.data(), d), position);
  return sorted;
}

Barycentric inMemberOrder(const Sorted& sorted) {
  Barycentric result = sorted.weights;
  for (std::size_t i = 0; i < sorted.order.size(); ++i) {
    result.free[sorted.order[i]] = sorted.weights.free[i];
    result.clamped[sorted.order[i]] = sorted.weights.clamped[i];
  }
  return result;
}

}  // namespace

double largestCoordinate(glm::dvec3 v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

CellDistance cellDistance(const Scene& scene, const Cell& cell, double size, const Pose& view) {
  const Sorted sorted = sortedWeights(scene, cell, view.position);
  CellDistance result;
  result.weights = inMemberOrder(sorted);
  const glm::dvec3 forward = viewAxis(view);
  glm::dvec3 axis(0.0);  // a panorama counts as looking along the view's axis
  bool anyPinhole = false;
  double magnitude = largestCoordinate(view.position);
  for (std::size_t i = 0; i < cell.members.size(); ++i) {
    const Camera& camera = scene.nodes[cell.members[sorted.order[i]]].camera;
    const bool panorama = camera.intrinsics.model == CameraModel::equirectangular;
    axis += sorted.weights.clamped[i] * (panorama ? forward : viewAxis(camera.pose));
    anyPinhole |= !panorama;
    magnitude = std::max(magnitude, largestCoordinate(camera.pose.position));
  }
  // Positions are rounded at the scale of the world, differences at the scale of the cell.
  const double tolerance = std::max(1e-9 * size, 8.0 * std::numeric_limits<double>::epsilon() * magnitude);
  result.extrapolation = sorted.weights.distance <= tolerance ? 0.0 : sorted.weights.distance;
  // atan2 is precise at small angles, acos is not.
  if (anyPinhole) result.rotation = std::atan2(glm::length(glm::cross(axis, forward)), glm::dot(axis, forward));
  return result;
}

Barycentric cellWeights(const Scene& scene, const Cell& cell, glm::dvec3 position) {
  return inMemberOrder(sortedWeights(scene, cell, position));
}

}  // namespace ibr
