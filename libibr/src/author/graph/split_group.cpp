// SPDX-License-Identifier: Apache-2.0
#include "author/graph/split_group.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <numeric>
#include <opencv2/core.hpp>
#include <set>

#include "author/cgal/delaunay.h"

namespace ibr {
namespace {

constexpr double kMinSpreadRatio = 0.10;       // ratio of spreads below which a dimension is dropped
constexpr double kMinTriangleShape = 0.12;     // shape
constexpr double kMinTetrahedronShape = 0.06;  // shape
constexpr double kMaxAreaRatio = 1.25;         // max ratio of areas

// Positions relative to their mean, along their principal axes (largest spread first), and the rank that they span.
struct Frame {
  std::vector<glm::dvec3> positions;
  int rank = 0;
};

Frame principalFrame(std::vector<glm::dvec3> positions) {
  const glm::dvec3 mean =
      std::accumulate(positions.begin(), positions.end(), glm::dvec3(0.0)) / double(positions.size());
  double scale = 0;
  for (glm::dvec3& p : positions) {
    p -= mean;
    scale = std::max(scale, glm::length(p));
  }
  Frame frame{std::move(positions), 0};
  if (!(scale > 0)) return frame;
  cv::Matx33d covariance = cv::Matx33d::zeros();
  for (const glm::dvec3& p : frame.positions)
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) covariance(r, c) += p[r] / scale * (p[c] / scale);
  cv::Mat squares, axes;
  cv::eigen(covariance, squares, axes);  // descending
  auto spread = [&](int i) { return std::sqrt(std::max(squares.at<double>(i), 0.0)); };
  frame.rank = spread(2) >= kMinSpreadRatio * spread(0) ? 3 : spread(1) >= kMinSpreadRatio * spread(0) ? 2 : 1;
  for (glm::dvec3& p : frame.positions) {
    glm::dvec3 turned(0.0);
    for (int r = 0; r < 3; ++r) {
      const glm::dvec3 axis(axes.at<double>(r, 0), axes.at<double>(r, 1), axes.at<double>(r, 2));
      turned[r] = glm::dot(axis, p);
    }
    p = turned;
  }
  return frame;
}

// Simplices of indices into `positions`.
std::vector<Simplex> splitPositions(std::vector<glm::dvec3> positions) {
  const Frame frame = principalFrame(std::move(positions));
  std::vector<Simplex> simplices;
  if (frame.rank == 3) {
    for (const glm::uvec4& t : delaunayTetrahedra(frame.positions)) simplices.push_back({t.x, t.y, t.z, t.w});
  } else if (frame.rank == 2) {
    const std::vector<glm::dvec2> flat(frame.positions.begin(), frame.positions.end());
    for (const glm::uvec3& t : delaunayTriangles(flat)) simplices.push_back({t.x, t.y, t.z});
  } else if (frame.rank == 1) {
    std::vector<std::uint32_t> order(frame.positions.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return frame.positions[a].x < frame.positions[b].x; });
    for (std::size_t k = 1; k < order.size(); ++k) simplices.push_back({order[k - 1], order[k]});
  }
  return simplices;
}

// A group's positions on the lattice of all sites, or on an own one. No simplices if the positions span none.
struct LatticeSplit {
  Lattice lattice;
  std::vector<std::uint32_t> position;  // for each view of the group: index into lattice.levels
  std::vector<Simplex> simplices;       // of views
};

std::optional<LatticeSplit> onLattice(const Views& views, const ViewGroup& group) {
  LatticeSplit split;
  if (views.lattice) {
    split.lattice = *views.lattice;
    for (const std::uint32_t i : group) split.position.push_back(views[i].site);
  } else if (auto own = findLattice(siteCentresOf(views, group))) {
    split.lattice = std::move(*own);
    split.position.resize(group.size());
    std::iota(split.position.begin(), split.position.end(), 0u);
  } else {
    return std::nullopt;
  }
  split.simplices = splitLattice(split.lattice, split.position);
  if (split.simplices.empty()) return std::nullopt;
  return split;
}

double sizeOf(const Views& views, const Simplex& face) {
  const auto at = cornersOf(views, face);
  return face.size() == 3 ? glm::length(glm::cross(at[1] - at[0], at[2] - at[0])) : glm::distance(at[0], at[1]);
}

std::vector<Simplex> partsWith(const Simplex& simplex, std::size_t members) {
  std::vector<Simplex> parts = faces(simplex);
  if (parts[0].size() == members) return parts;
  std::vector<Simplex> edges;
  for (const Simplex& part : parts)
    for (Simplex& edge : faces(part)) edges.push_back(std::move(edge));
  return edges;
}

std::vector<Simplex> alongAxes(const LatticeSplit& split, const ViewGroup& group, std::size_t members) {
  std::set<Simplex> along;
  for (const Simplex& simplex : split.simplices)
    for (const Simplex& part : partsWith(simplex, members)) {
      std::vector<std::uint32_t> positions;
      for (const std::uint32_t i : part)
        positions.push_back(
            split.position[std::size_t(std::lower_bound(group.begin(), group.end(), i) - group.begin())]);
      if (extent(split.lattice, positions) < int(members)) along.insert(part);
    }
  return {along.begin(), along.end()};
}

std::vector<Simplex> similarParts(const Views& views, const std::vector<Simplex>& simplices, std::size_t members) {
  std::map<Simplex, bool> candidates;  // → true if similar to the smallest part of one of its simplices
  for (const Simplex& simplex : simplices) {
    // Skips slivers: their faces overlap.
    if (members == 3 && shape(cornersOf(views, simplex)) < minShape(simplex.size())) continue;
    const std::vector<Simplex> parts = partsWith(simplex, members);
    double smallest = std::numeric_limits<double>::infinity();
    for (const Simplex& part : parts) smallest = std::min(smallest, sizeOf(views, part));
    for (const Simplex& part : parts)
      candidates[part] |= members == 2 || sizeOf(views, part) <= kMaxAreaRatio * smallest;
  }
  std::vector<std::pair<double, Simplex>> bySize;
  std::set<std::uint32_t> reached;
  for (const auto& [part, similar] : candidates) {
    bySize.emplace_back(sizeOf(views, part), part);
    if (similar) reached.insert(part.begin(), part.end());
  }
  std::sort(bySize.begin(), bySize.end());
  std::vector<Simplex> result;
  for (const auto& [size, part] : bySize) {
    const bool lonely = std::any_of(part.begin(), part.end(), [&](std::uint32_t i) { return !reached.contains(i); });
    if (!candidates[part] && !lonely) continue;
    reached.insert(part.begin(), part.end());
    result.push_back(part);
  }
  return result;
}

}  // namespace

double minShape(std::size_t members) {
  return members == 4 ? kMinTetrahedronShape : members == 3 ? kMinTriangleShape : 1e-12;
}

GroupSplit splitGroup(const Views& views, const ViewGroup& group, std::size_t maxMembers) {
  const auto ofViews = [&](std::vector<Simplex> simplices) {
    for (Simplex& simplex : simplices) {
      for (std::uint32_t& i : simplex) i = group[i];
      std::sort(simplex.begin(), simplex.end());
    }
    std::sort(simplices.begin(), simplices.end());
    return simplices;
  };
  auto lattice = onLattice(views, group);
  if (lattice) lattice->simplices = ofViews(std::move(lattice->simplices));
  GroupSplit split{lattice ? lattice->simplices : ofViews(splitPositions(siteCentresOf(views, group))), false};
  if (split.simplices.empty() || split.simplices[0].size() <= maxMembers) return split;
  split.overlaps = true;
  split.simplices = lattice ? alongAxes(*lattice, group, maxMembers) : similarParts(views, split.simplices, maxMembers);
  return split;
}

}  // namespace ibr
