// SPDX-License-Identifier: Apache-2.0
#include "render/plan/outline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>
#include <utility>
#include <vector>

#include "render/plan/vertex.h"

namespace ibr {
namespace {

// Sum of the directed borders of tier 0: edges between equally oriented neighbours cancel. `total`: number of edges
// before that.
std::vector<glm::uvec2> borderOf(const Scene& scene, const Cell& cell, std::size_t& total) {
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
  total = edges.size();
  std::vector<glm::uvec2> border;
  for (std::size_t first = 0, last = 0; first < edges.size(); first = last) {
    int sum = 0;
    for (; last < edges.size() && edges[last][0] == edges[first][0] && edges[last][1] == edges[first][1]; ++last)
      sum += edges[last][2] ? -1 : 1;
    const glm::uvec2 edge(edges[first][0], edges[first][1]);
    for (int n = 0; n < std::abs(sum); ++n) border.push_back(sum > 0 ? edge : glm::uvec2(edge.y, edge.x));
  }
  return border;
}

using Walk = std::vector<std::uint32_t>;  // closed: points of the mesh; the last one is joined to the first

// As many edges leave each point as arrive, so every walk returns to its start.
std::vector<Walk> walksOf(std::vector<glm::uvec2> border) {
  std::ranges::sort(border, {}, [](glm::uvec2 edge) { return std::pair(edge.x, edge.y); });
  std::vector<bool> used(border.size());
  std::map<std::uint32_t, std::size_t> next;  // by point: its first edge that may be unused
  for (std::size_t e = border.size(); e-- > 0;) next[border[e].x] = e;
  std::vector<Walk> walks;
  for (std::size_t e = 0; e < border.size(); ++e) {
    if (used[e]) continue;
    Walk& walk = walks.emplace_back();
    for (std::size_t at = e;;) {
      used[at] = true;
      walk.push_back(border[at].x);
      std::size_t& following = next.at(border[at].y);
      while (following < border.size() && border[following].x == border[at].y && used[following]) ++following;
      if (following == border.size() || border[following].x != border[at].y) break;  // back at the start
      at = following;
    }
  }
  return walks;
}

// Values of a point: a_i r_i and r_i by member, ρ.
struct Values {
  std::array<glm::dvec3, 4> point{}, ray{};
  double inverseDistance = 0;
};

struct Deviation {
  std::array<double, 4> member{};
  double inverseDistance = 0;

  void extend(const Deviation& other) {
    for (std::size_t i = 0; i < 4; ++i) member[i] = std::max(member[i], other.member[i]);
    inverseDistance = std::max(inverseDistance, other.inverseDistance);
  }
};

// An edge from point to point, and the deviation of the chain that it stands for.
struct Chain {
  std::uint32_t from, to;
  Deviation deviation;
};

class Simplifier {
 public:
  Simplifier(const Scene& scene, const Cell& cell, double size, std::vector<Walk> walks)
      : members_(cell.members.size()), size_(size), walks_(std::move(walks)) {
    sortByPlace(scene, cell);
    for (const Walk& walk : walks_) {
      length_ += walk.size();
      std::vector<Values>& values = values_.emplace_back();
      for (const std::uint32_t point : walk) values.push_back(valuesOf(scene, cell, point));
    }
  }

  // Returns at most `most` chains, >= 1.
  std::vector<Chain> simplified(std::size_t most) const {
    if (length_ <= most) return simplifiedTo(0, most);
    for (double tolerance = 1e-4; std::isfinite(tolerance); tolerance *= 1.5)
      if (std::vector<Chain> chains = simplifiedTo(tolerance, most); chains.size() <= most) return chains;
    return {};
  }

 private:
  Values valuesOf(const Scene& scene, const Cell& cell, std::uint32_t point) const {
    Values values;
    for (std::size_t i = 0; i < members_; ++i) {
      values.point[i] = memberPoint(scene, cell, i, point);
      values.ray[i] = glm::normalize(values.point[i]);
    }
    values.inverseDistance = cell.mesh.inverseDistance[point];
    return values;
  }

  // Deviation of a point from the segment between two others. Its share of the way is the same for all members.
  Deviation deviationOf(const Values& a, const Values& b, const Values& p) const {
    double along = 0, squared = 0;
    for (std::size_t i = 0; i < members_; ++i) {
      along += glm::dot(b.point[i] - a.point[i], p.point[i] - a.point[i]);
      squared += glm::dot(b.point[i] - a.point[i], b.point[i] - a.point[i]);
    }
    const double share = squared > 0 ? std::clamp(along / squared, 0.0, 1.0) : 0.0;
    Deviation deviation;
    for (std::size_t i = 0; i < members_; ++i)
      deviation.member[i] = std::max(glm::length(p.point[i] - glm::mix(a.point[i], b.point[i], share)),
                                     glm::length(p.ray[i] - glm::mix(a.ray[i], b.ray[i], share)));
    deviation.inverseDistance = std::abs(p.inverseDistance - glm::mix(a.inverseDistance, b.inverseDistance, share));
    return deviation;
  }

  bool within(const Deviation& deviation, double tolerance) const {
    return *std::ranges::max_element(deviation.member) + deviation.inverseDistance * size_ <= tolerance;
  }

  // Walks of neighbouring points follow each other: along rows of a grid over the first member's photograph.
  void sortByPlace(const Scene& scene, const Cell& cell) {
    const Intrinsics& k = scene.nodes[cell.members[0]].camera.intrinsics;
    std::ranges::stable_sort(walks_, {}, [&](const Walk& walk) {
      const glm::vec2 at = cell.mesh.match[0][walk[0]];
      const float row = std::floor(16 * at.y / float(k.height));
      return std::pair(row, std::fmod(row, 2.0f) != 0 ? -at.x : at.x);
    });
  }

  // Ends early with more than `most` chains.
  std::vector<Chain> simplifiedTo(double tolerance, std::size_t most) const {
    std::vector<Chain> chains;
    const Values* middle = nullptr;  // of the last chain, if it stands for whole walks
    for (std::size_t w = 0; w < walks_.size() && chains.size() <= most; ++w) {
      if (tolerance > 0) {
        if (middle && absorb(chains.back(), *middle, values_[w], tolerance)) continue;
        Chain whole{walks_[w][0], walks_[w][0], {}};
        if (absorb(whole, values_[w][0], values_[w], tolerance)) {
          chains.push_back(whole);
          middle = &values_[w][0];
          continue;
        }
      }
      addChains(walks_[w], values_[w], tolerance, most, chains);
      middle = nullptr;
    }
    return chains;
  }

  // Extends a chain of length 0 by a walk, unless the walk leaves the tolerance.
  bool absorb(Chain& chain, const Values& middle, const std::vector<Values>& walk, double tolerance) const {
    Deviation all = chain.deviation;
    for (const Values& values : walk) {
      all.extend(deviationOf(middle, middle, values));
      if (!within(all, tolerance)) return false;
    }
    chain.deviation = all;
    return true;
  }

  // Splits a walk into chains. Their lengths grow by doubling, then by halved steps.
  void addChains(const Walk& walk, const std::vector<Values>& values, double tolerance, std::size_t most,
                 std::vector<Chain>& chains) const {
    const std::size_t n = walk.size();
    for (std::size_t first = 0; first < n && chains.size() <= most;) {
      std::size_t length = 1;
      Deviation deviation;
      const auto grow = [&](std::size_t wanted) {
        if (first + wanted > n) return false;
        Deviation longer;
        for (std::size_t p = first + 1; p < first + wanted; ++p) {
          longer.extend(deviationOf(values[first], values[(first + wanted) % n], values[p]));
          if (!within(longer, tolerance)) return false;
        }
        length = wanted;
        deviation = longer;
        return true;
      };
      if (tolerance > 0) {
        std::size_t step = 1;
        while (grow(length + step)) step *= 2;
        for (; step > 0; step /= 2) grow(length + step);
      }
      chains.push_back({walk[first], walk[(first + length) % n], deviation});
      first += length;
    }
  }

  std::size_t members_;
  double size_;
  std::vector<Walk> walks_;
  std::vector<std::vector<Values>> values_;  // of the walks' points
  std::size_t length_ = 0;                   // sum of all walks, edges
};

}  // namespace

void addOutline(const Scene& scene, const Cell& cell, CellBounds& bounds) {
  std::size_t total = 0;
  const std::vector<glm::uvec2> border = borderOf(scene, cell, total);
  if (border.empty() || border.size() > total / 3) return;
  std::map<std::uint32_t, std::uint32_t> cornerOf;
  const auto corner = [&](std::uint32_t p) {
    const auto [found, isNew] = cornerOf.emplace(p, std::uint32_t(bounds.corners.size()));
    if (isNew) {
      CellBounds::Corner& made = bounds.corners.emplace_back();
      for (std::size_t i = 0; i < cell.members.size(); ++i) made.point[i] = glm::vec3(memberPoint(scene, cell, i, p));
      made.inverseDistance = cell.mesh.inverseDistance[p];
    }
    return found->second;
  };
  constexpr double kRoundUp = 1 + 1e-6;  // for values stored as floats
  const Simplifier simplifier(scene, cell, bounds.size, walksOf(border));
  for (const auto& [from, to, deviation] : simplifier.simplified(kMaxOutlineEdges)) {
    CellBounds::OutlineEdge& edge = bounds.outline.emplace_back();
    edge.from = corner(from);
    edge.to = corner(to);
    for (std::size_t i = 0; i < 4; ++i) edge.deviation[i] = float(kRoundUp * deviation.member[i]);
    edge.inverseDistanceDeviation = float(kRoundUp * deviation.inverseDistance);
  }
}

}  // namespace ibr
