// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdlib>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "base/stop.h"
#include "ibr/frame_plan.h"
#include "render/plan/anchors.h"
#include "render/plan/photograph_choice.h"
#include "render/plan/vertex.h"

namespace ibr {

namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

void addOutline(const Scene& scene, const Cell& cell, CellBounds& bounds);

CellBounds boundsOf(const Scene& scene, const Cell& cell) {
  CellBounds bounds;
  for (std::size_t i = 0; i < cell.members.size(); ++i) {
    CellBounds::Member& member = bounds.members.emplace_back();
    for (std::size_t p = 0; p < cell.mesh.vertexCount(); ++p) {
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
    bounds.maxInverseDistance = std::max(bounds.maxInverseDistance, inverseDistance);
  if (std::vector<float> all = cell.mesh.inverseDistance; !all.empty()) {
    const auto quantile = [&](std::size_t tenths) {
      const auto at = all.begin() + std::ptrdiff_t((all.size() - 1) * tenths / 10);
      std::nth_element(all.begin(), at, all.end());
      return *at;
    };
    bounds.farInverseDistance = quantile(1);
    bounds.nearInverseDistance = quantile(9);
  }
  addOutline(scene, cell, bounds);
  bounds.surface = surfacePoints(scene, cell);
  return bounds;
}

// Edges between equally oriented neighbours cancel. A mesh with a long border covers little: its outline is dropped.
void addOutline(const Scene& scene, const Cell& cell, CellBounds& bounds) {
  const MorphMesh& mesh = cell.mesh;
  const std::vector<bool> usable = usablePoints(scene, cell);
  std::vector<std::array<std::uint32_t, 3>> edges;  // lower, higher index; 1: from higher to lower
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::uvec3 v = mesh.triangles[t];
    if (mesh.tier[t] != kTierConsistent || !usable[v.x] || !usable[v.y] || !usable[v.z]) continue;
    for (int e = 0; e < 3; ++e) {
      const std::uint32_t from = v[e], to = v[(e + 1) % 3];
      if (from != to) edges.push_back({std::min(from, to), std::max(from, to), from > to});
    }
  }
  std::sort(edges.begin(), edges.end());
  std::vector<std::uint32_t> cornerOf(mesh.vertexCount(), kNone);
  const auto corner = [&](std::uint32_t p) {
    if (cornerOf[p] == kNone) {
      cornerOf[p] = std::uint32_t(bounds.corners.size());
      CellBounds::Corner& made = bounds.corners.emplace_back();
      for (std::size_t i = 0; i < cell.members.size(); ++i) made.point[i] = glm::vec3(memberPoint(scene, cell, i, p));
      made.inverseDistance = mesh.inverseDistance[p];
    }
    return cornerOf[p];
  };
  for (std::size_t first = 0, last = 0; first < edges.size(); first = last) {
    int sum = 0;
    for (; last < edges.size() && edges[last][0] == edges[first][0] && edges[last][1] == edges[first][1]; ++last)
      sum += edges[last][2] ? -1 : 1;
    for (int n = 0; n < std::abs(sum); ++n) {
      const std::uint32_t low = corner(edges[first][0]), high = corner(edges[first][1]);
      bounds.outline.push_back(sum > 0 ? glm::uvec2(low, high) : glm::uvec2(high, low));
    }
  }
  constexpr std::size_t kMaxEdges = 16384;
  if (bounds.outline.size() > std::min(kMaxEdges, edges.size() / 3)) {
    bounds.outline.clear();
    bounds.corners.clear();
  }
}

}  // namespace

SceneBounds sceneBounds(const Scene& scene, const std::stop_token& stop) {
  SceneBounds bounds;
  for (const Cell& cell : scene.cells) {
    checkStop(stop, "computing a scene's bounds");
    bounds.cells.push_back(boundsOf(scene, cell));
  }
  if (!gatherableBackdrops(scene).empty()) bounds.gather = gatherStatistics(scene, stop);
  bounds.anchors = std::make_shared<SceneBounds::Anchors>();
  return bounds;
}

}  // namespace ibr
