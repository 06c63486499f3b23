// SPDX-License-Identifier: Apache-2.0
// Groups points by their minimum spanning tree, whose edges are of two kinds: within and between capture sites.
#include "vr/walk/groups.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>

namespace ibr::app {
namespace {

constexpr double kShare = 0.05;           // of the median distance between sites: closer points share a site
constexpr double kGap = 100;              // ratio of successive edge lengths that separates the two kinds …
constexpr std::size_t kMinLongEdges = 4;  // … if at least this many edges are longer
constexpr double kRounding = 1e4;         // ratio that always separates: the shorter edges are rounding errors

struct Edge {
  double length = std::numeric_limits<double>::infinity();
  std::uint32_t from = 0, to = 0;
};

// Prim's algorithm, O(n²). Returns the finite edges, ascending.
std::vector<Edge> shortestTree(const std::vector<glm::dvec3>& points) {
  std::vector<Edge> edges, nearest(points.size());
  std::vector<char> joined(points.size(), 0);
  std::uint32_t last = 0;
  for (std::size_t count = 1; count < points.size(); ++count) {
    joined[last] = 1;
    std::uint32_t next = last;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      if (joined[i]) continue;
      if (const double length = glm::distance(points[last], points[i]); length < nearest[i].length)
        nearest[i] = {length, last, i};
      if (joined[next] || nearest[i].length < nearest[next].length) next = i;
    }
    edges.push_back(nearest[next]);
    edges.back().to = next;
    last = next;
  }
  std::erase_if(edges, [](const Edge& edge) { return !std::isfinite(edge.length); });
  std::ranges::stable_sort(edges, {}, &Edge::length);
  return edges;
}

// Returns the greatest distance of neighbouring points within one site.
double samePositionTolerance(const std::vector<Edge>& edges) {
  std::size_t within = 0;  // edges
  for (std::size_t i = 1; i < edges.size(); ++i) {
    const double ratio = edges[i].length / edges[i - 1].length;  // infinite after equal points
    if (ratio >= kRounding || (ratio >= kGap && edges.size() - i >= kMinLongEdges)) within = i;
  }
  if (within == edges.size()) return 0;
  const double middle = edges[within + (edges.size() - within) / 2].length;
  const double gap = within > 0 ? edges[within - 1].length : 0;
  return std::max(gap, kShare * middle);
}

std::uint32_t rootOf(std::vector<std::uint32_t>& parents, std::uint32_t i) {
  while (parents[i] != i) i = parents[i] = parents[parents[i]];
  return i;
}

}  // namespace

std::vector<std::vector<std::uint32_t>> groupsOf(const std::vector<glm::dvec3>& points) {
  const std::vector<Edge> edges = shortestTree(points);
  const double same = samePositionTolerance(edges);
  std::vector<std::uint32_t> parents(points.size());
  std::iota(parents.begin(), parents.end(), 0u);
  for (const Edge& edge : edges)
    if (edge.length <= same) {
      const std::uint32_t a = rootOf(parents, edge.from), b = rootOf(parents, edge.to);
      parents[std::max(a, b)] = std::min(a, b);
    }
  std::vector<std::vector<std::uint32_t>> byRoot(points.size()), groups;
  for (std::uint32_t i = 0; i < points.size(); ++i) byRoot[rootOf(parents, i)].push_back(i);
  for (std::vector<std::uint32_t>& group : byRoot)
    if (!group.empty()) groups.push_back(std::move(group));
  return groups;
}

}  // namespace ibr::app
