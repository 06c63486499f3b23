// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "ibr/renderer.h"
#include "render/vertex.h"

namespace ibr {

namespace {

CellBounds boundsOf(const Scene& scene, const Cell& cell) {
  CellBounds bounds;
  for (std::size_t i = 0; i < cell.members.size(); ++i) {
    CellBounds::Member& member = bounds.members.emplace_back();
    for (std::size_t p = 0; p < cell.mesh.pointCount(); ++p) {
      const glm::vec3 point(memberPoint(scene, cell, i, p)), ray = glm::normalize(point);
      member.low = p ? glm::min(member.low, point) : point;
      member.high = p ? glm::max(member.high, point) : point;
      member.unitLow = p ? glm::min(member.unitLow, ray) : ray;
      member.unitHigh = p ? glm::max(member.unitHigh, ray) : ray;
    }
    for (std::size_t j = 0; j < i; ++j)
      bounds.size = std::max(bounds.size, glm::distance(scene.nodes[cell.members[i]].camera.pose.position,
                                                        scene.nodes[cell.members[j]].camera.pose.position));
  }
  for (float inverseDistance : cell.mesh.inverseDistance)
    bounds.largestInverseDistance = std::max(bounds.largestInverseDistance, inverseDistance);
  if (std::vector<float> all = cell.mesh.inverseDistance; !all.empty()) {
    const auto quantile = [&](std::size_t tenths) {
      const auto at = all.begin() + std::ptrdiff_t((all.size() - 1) * tenths / 10);
      std::nth_element(all.begin(), at, all.end());
      return *at;
    };
    bounds.farInverseDistance = quantile(1);
    bounds.nearInverseDistance = quantile(9);
  }
  return bounds;
}

}  // namespace

SceneBounds sceneBounds(const Scene& scene) {
  SceneBounds bounds;
  for (const Cell& cell : scene.cells) bounds.cells.push_back(boundsOf(scene, cell));
  for (const Cell& backdrop : scene.backdrops) bounds.backdrops.push_back(boundsOf(scene, backdrop));
  return bounds;
}

}  // namespace ibr
