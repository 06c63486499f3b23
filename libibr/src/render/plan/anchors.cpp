// SPDX-License-Identifier: Apache-2.0
//
// A point inside a triangle is Σ β_v (q_i, ρ)_v with β ≥ 0, and member i sees the point along Σ β_v q_i,v. Up to a
// factor, β is therefore the photograph's ray in the basis of the corners' q_i, for pinholes and panoramas alike.
#include "render/plan/anchors.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "base/stop.h"
#include "render/plan/vertex.h"

namespace ibr {
namespace {

glm::dvec2 pixelOf(const Intrinsics& k, glm::uvec2 gridPoint) {
  return (glm::dvec2(gridPoint) + 0.5) / double(kAnchorSide) * glm::dvec2(k.width, k.height);
}

// Returns the grid points within a triangle's bounding box: first, and one past the last. Returns none for a triangle
// that spans more than half of a panorama: such a triangle crosses the panorama's seam.
std::array<glm::uvec2, 2> gridPointsIn(const Intrinsics& k, const std::array<glm::vec2, 3>& corners) {
  const glm::dvec2 size(k.width, k.height), low = glm::min(glm::min(corners[0], corners[1]), corners[2]),
                                            high = glm::max(glm::max(corners[0], corners[1]), corners[2]);
  if (k.model == CameraModel::equirectangular && high.x - low.x > 0.5 * size.x) return {};
  const auto at = [&](glm::dvec2 pixel, double add) {
    return glm::uvec2(glm::clamp(glm::ceil(pixel / size * double(kAnchorSide) - 0.5) + add, 0.0, double(kAnchorSide)));
  };
  return {at(low, 0), at(high, 1)};
}

// Nearest surface at each grid point of one photograph.
class Lookup {
 public:
  Lookup(const Scene& scene, const Cell& mesh, std::size_t member)
      : scene_(scene), mesh_(mesh), member_(member), k_(scene.nodes[mesh.members[member]].camera.intrinsics) {}

  void add(glm::uvec3 triangle) {
    glm::dmat3 corners;
    for (int v = 0; v < 3; ++v) corners[v] = memberPoint(scene_, mesh_, member_, triangle[v]);
    const auto& match = mesh_.mesh.match[member_];
    const auto [from, end] = gridPointsIn(k_, {match[triangle.x], match[triangle.y], match[triangle.z]});
    if (from.x >= end.x || from.y >= end.y) return;
    const glm::dmat3 toCorners = glm::inverse(corners);
    for (std::uint32_t y = from.y; y < end.y; ++y)
      for (std::uint32_t x = from.x; x < end.x; ++x) {
        const glm::dvec3 share = toCorners * unproject(k_, pixelOf(k_, {x, y}));
        const double sum = share.x + share.y + share.z;
        if (share.x >= 0 && share.y >= 0 && share.z >= 0 && sum > 0 && std::isfinite(sum))
          keep(y * kAnchorSide + x, triangle, share / sum);
      }
  }

  void moveTo(std::vector<CellBounds::Anchor>& anchors) const {
    for (std::uint32_t cell = 0; cell < nearness_.size(); ++cell)
      if (nearness_[cell] >= 0) anchors.push_back({mesh_.members[member_], cell, found_[cell]});
  }

 private:
  // Keeps the point if it is nearer than the grid cell's point so far.
  void keep(std::uint32_t gridCell, glm::uvec3 triangle, glm::dvec3 share) {
    double inverseDistance = 0;
    glm::dvec3 along(0.0);
    for (int v = 0; v < 3; ++v) {
      inverseDistance += share[v] * double(mesh_.mesh.inverseDistance[triangle[v]]);
      along += share[v] * memberPoint(scene_, mesh_, member_, triangle[v]);
    }
    const double nearness = inverseDistance / glm::length(along);
    if (!(nearness > nearness_[gridCell])) return;
    nearness_[gridCell] = nearness;
    CellBounds::Corner& point = found_[gridCell] = {};
    point.inverseDistance = float(inverseDistance);
    for (std::size_t i = 0; i < mesh_.members.size(); ++i)
      for (int v = 0; v < 3; ++v) point.point[i] += glm::vec3(share[v] * memberPoint(scene_, mesh_, i, triangle[v]));
  }

  const Scene& scene_;
  const Cell& mesh_;
  std::size_t member_;
  const Intrinsics& k_;
  std::vector<double> nearness_ = std::vector<double>(kAnchorSide * kAnchorSide, -1);  // 1 / distance; −1: no surface
  std::vector<CellBounds::Corner> found_{kAnchorSide * kAnchorSide};
};

void addAnchors(const Scene& scene, const Cell& cell, std::size_t member, const std::vector<bool>& usable,
                std::vector<CellBounds::Anchor>& anchors) {
  Lookup lookup(scene, cell, member);
  for (std::size_t t = 0, count = cell.mesh.tier0Count(); t < count; ++t) {
    const glm::uvec3 v = cell.mesh.triangles[t];
    if (usable[v.x] && usable[v.y] && usable[v.z]) lookup.add(v);
  }
  lookup.moveTo(anchors);
}

}  // namespace

std::vector<std::uint32_t> cellsOfNodes(const Scene& scene) {
  std::vector<std::uint32_t> count(scene.nodes.size(), 0);
  for (const Cell& cell : scene.cells)
    for (const std::uint32_t node : cell.members) ++count[node];
  return count;
}

std::vector<CellBounds::Anchor> anchorsOf(const Scene& scene, const Cell& cell,
                                          std::span<const std::uint32_t> cellsOfNode) {
  std::vector<std::size_t> members;
  for (std::size_t i = 0; i < cell.members.size(); ++i)
    if (cellsOfNode[cell.members[i]] > 1) members.push_back(i);
  std::ranges::sort(members, {}, [&](std::size_t i) { return cell.members[i]; });
  if (members.empty()) return {};
  const std::vector<bool> usable = usablePoints(scene, cell);
  std::vector<CellBounds::Anchor> anchors;
  for (const std::size_t member : members) addAnchors(scene, cell, member, usable, anchors);
  return anchors;
}

std::vector<glm::vec4> surfacePoints(const Scene& scene, const Cell& cell) {
  std::vector<CellBounds::Anchor> anchors;
  addAnchors(scene, cell, 0, usablePoints(scene, cell), anchors);
  const glm::dmat3 toWorld = glm::mat3_cast(scene.nodes[cell.members[0]].camera.pose.rotation);
  std::vector<glm::vec4> points;
  for (const CellBounds::Anchor& anchor : anchors)
    if ((anchor.gridCell / kAnchorSide + anchor.gridCell) % 2 == 0)  // every second one, as on a chessboard
      points.emplace_back(glm::vec3(toWorld * glm::dvec3(anchor.point.point[0])), anchor.point.inverseDistance);
  return points;
}

const SceneBounds::Anchors::OfCells& SceneBounds::Anchors::of(const Scene& scene, const std::stop_token& stop) {
  std::call_once(once_, [&] {
    const std::vector<std::uint32_t> cellsOfNode = cellsOfNodes(scene);
    OfCells all;
    for (const Cell& cell : scene.cells) {
      checkStop(stop, "computing a scene's anchors");
      all.push_back(anchorsOf(scene, cell, cellsOfNode));
    }
    all_ = std::move(all);
  });
  return all_;
}

}  // namespace ibr
