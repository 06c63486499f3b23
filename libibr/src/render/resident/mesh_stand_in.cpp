// SPDX-License-Identifier: Apache-2.0
#include "render/resident/mesh_stand_in.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>
#include <set>
#include <span>
#include <utility>

#include "render/plan/vertex.h"

namespace ibr {
namespace {

constexpr std::uint32_t kNone = ~0u;
constexpr int kSquares = 5;            // of the finest grid, along each side: 2·5² triangles where one sheet fills it
constexpr double kMinAreaShare = 0.9;  // of the mesh's area that a stand-in should cover

double area(const std::vector<glm::vec2>& at, glm::uvec3 t) {
  const glm::dvec2 a = glm::dvec2(at[t.y]) - glm::dvec2(at[t.x]), b = glm::dvec2(at[t.z]) - glm::dvec2(at[t.x]);
  return std::abs(a.x * b.y - a.y * b.x) / 2;
}

double area(const std::vector<glm::vec2>& at, const std::vector<glm::uvec3>& triangles) {
  double sum = 0;
  for (const glm::uvec3 t : triangles) sum += area(at, t);
  return sum;
}

class Clustering {
 public:
  Clustering(const std::vector<glm::vec2>& at, const std::vector<glm::uvec3>& triangles)
      : at_(at), triangles_(triangles) {
    low_ = high_ = at[triangles[0].x];
    for (const glm::uvec3 t : triangles)
      for (int v = 0; v < 3; ++v) {
        low_ = glm::min(low_, at[t[v]]);
        high_ = glm::max(high_, at[t[v]]);
      }
  }

  // Returns triangles between representatives, in vertices of the mesh.
  std::vector<glm::uvec3> triangles(int squares, bool keepsApart) {
    cluster(squares, keepsApart);
    std::vector<glm::uvec3> result;
    std::set<std::array<std::uint32_t, 3>> seen;
    for (const glm::uvec3 t : triangles_) {
      const glm::uvec3 to{of_[root(t.x)], of_[root(t.y)], of_[root(t.z)]};
      if (to.x == to.y || to.y == to.z || to.z == to.x) continue;
      std::array<std::uint32_t, 3> key{to.x, to.y, to.z};
      std::ranges::sort(key);
      if (seen.insert(key).second) result.push_back(to);
    }
    return result;
  }

 private:
  glm::vec2 scaled(std::uint32_t p, int squares) const {  // nodes have whole numbers
    const glm::vec2 extent = glm::max(high_ - low_, glm::vec2(1e-6f));
    return (at_[p] - low_) / extent * float(squares);
  }

  int nodeOf(std::uint32_t p, int squares) const {
    const glm::vec2 node = glm::round(scaled(p, squares));
    return int(node.y) * (squares + 1) + int(node.x);
  }

  std::uint32_t root(std::uint32_t p) {
    while (parent_[p] != p) p = parent_[p] = parent_[parent_[p]];
    return p;
  }

  void cluster(int squares, bool keepsApart) {
    parent_.resize(at_.size());
    std::iota(parent_.begin(), parent_.end(), 0u);
    of_.assign(at_.size(), kNone);
    std::vector<std::uint32_t> first(std::size_t(squares + 1) * std::size_t(squares + 1), kNone);  // of each node
    const auto join = [&](std::uint32_t a, std::uint32_t b) {
      a = root(a), b = root(b);
      parent_[std::max(a, b)] = std::min(a, b);
    };
    for (const glm::uvec3 t : triangles_)
      for (int v = 0; v < 3; ++v) {
        const std::uint32_t a = t[v], b = t[(v + 1) % 3];
        const int node = nodeOf(a, squares);
        if (!keepsApart) {
          std::uint32_t& any = first[std::size_t(node)];
          any == kNone ? void(any = a) : join(any, a);
        } else if (node == nodeOf(b, squares)) {
          join(a, b);
        }
      }
    const auto distance = [&](std::uint32_t p) {
      const glm::vec2 at = scaled(p, squares);
      return glm::distance(at, glm::round(at));
    };
    for (const glm::uvec3 t : triangles_)
      for (int v = 0; v < 3; ++v) {
        std::uint32_t& best = of_[root(t[v])];
        const auto order = [&](std::uint32_t p) { return std::pair(distance(p), p); };
        if (best == kNone || order(t[v]) < order(best)) best = t[v];
      }
  }

  const std::vector<glm::vec2>& at_;
  const std::vector<glm::uvec3>& triangles_;
  glm::vec2 low_, high_;
  std::vector<std::uint32_t> parent_;  // of a vertex in its cluster
  std::vector<std::uint32_t> of_;      // representative of a cluster, by its root
};

MeshPart partOf(const std::vector<glm::uvec3>& triangles) {
  MeshPart part;
  for (const glm::uvec3 t : triangles) part.points.insert(part.points.end(), {t.x, t.y, t.z});
  std::ranges::sort(part.points);
  part.points.erase(std::unique(part.points.begin(), part.points.end()), part.points.end());
  const auto index = [&](std::uint32_t p) {
    return std::uint32_t(std::ranges::lower_bound(part.points, p) - part.points.begin());
  };
  for (const glm::uvec3 t : triangles) part.triangles.emplace_back(index(t.x), index(t.y), index(t.z));
  return part;
}

// Keeps the largest triangles in the image.
void keepLargest(const std::vector<glm::vec2>& at, std::vector<glm::uvec3>& triangles) {
  if (triangles.size() <= kMaxStandInTriangles) return;
  std::ranges::stable_sort(triangles, std::ranges::greater(), [&](glm::uvec3 t) { return area(at, t); });
  triangles.resize(kMaxStandInTriangles);
}

}  // namespace

std::vector<glm::uvec3> drawnTriangles(const Scene& scene, const Cell& cell) {
  const std::vector<bool> usable = usablePoints(scene, cell);
  std::vector<glm::uvec3> drawn;
  drawn.reserve(cell.mesh.triangles.size());
  for (const glm::uvec3 v : std::span(cell.mesh.triangles).first(cell.mesh.tier0Count()))
    if (usable[v.x] && usable[v.y] && usable[v.z]) drawn.push_back(v);
  return drawn;
}

MeshPart meshStandIn(const Cell& cell, const std::vector<glm::uvec3>& triangles) {
  if (triangles.size() <= kMaxStandInTriangles) return partOf(triangles);
  const std::vector<glm::vec2>& at = cell.mesh.match[0];
  const double whole = area(at, triangles);
  Clustering clustering(at, triangles);
  std::vector<glm::uvec3> best;
  double bestArea = -1;
  for (const bool keepsApart : {true, false}) {
    std::vector<glm::uvec3> found;
    for (int squares = kSquares; squares > 0; --squares) {
      found = clustering.triangles(squares, keepsApart);
      if (found.size() <= kMaxStandInTriangles) break;
    }
    keepLargest(at, found);
    const double covered = std::min(area(at, found), whole);
    if (covered > bestArea) bestArea = covered, best = std::move(found);
    if (bestArea >= kMinAreaShare * whole) break;
  }
  return partOf(best);
}

}  // namespace ibr
