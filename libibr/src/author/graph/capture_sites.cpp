// SPDX-License-Identifier: Apache-2.0
#include "author/graph/capture_sites.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>

namespace ibr {
namespace {

constexpr double kMinGapRatio = 4.0;       // min ratio of successive edge lengths where the tree may be cut
constexpr double kMaxSiteExtent = 0.5;     // max extent of a site, relative to the shortest edge between sites
constexpr double kMaxPointExtent = 0.01;   // likewise: below, directions do not matter
constexpr double kMaxLoneShare = 0.25;     // max share of sites with a single photograph
constexpr double kMinAxisCosine = 0.9397;  // cos 20°: max angle of photographs in the same direction

bool areCaptureSites(std::span<const Camera> cameras, const std::vector<std::uint32_t>& site, double between) {
  const std::size_t siteCount = 1 + *std::max_element(site.begin(), site.end());
  std::vector<std::vector<std::uint32_t>> members(siteCount);
  for (std::uint32_t i = 0; i < site.size(); ++i) members[site[i]].push_back(i);
  std::size_t lone = 0, sameWay = 0, several = 0;
  double largest = 0;
  for (const auto& list : members) {
    if (list.size() == 1) {
      ++lone;
      continue;
    }
    several += list.size();
    for (const std::uint32_t i : list) {
      bool company = false;
      for (const std::uint32_t j : list) {
        if (i == j) continue;
        largest = std::max(largest, glm::distance(cameras[i].pose.position, cameras[j].pose.position));
        company |= glm::dot(viewAxis(cameras[i].pose), viewAxis(cameras[j].pose)) > kMinAxisCosine;
      }
      sameWay += company;
    }
  }
  if (largest > kMaxSiteExtent * between || double(lone) > kMaxLoneShare * double(siteCount)) return false;
  return largest <= kMaxPointExtent * between || 2 * sameWay <= several;
}

}  // namespace

std::vector<TreeEdge> spanningTree(std::span<const glm::dvec3> points) {
  const std::size_t n = points.size();
  std::vector<TreeEdge> nearest(n, {std::numeric_limits<double>::infinity(), 0, 0}), tree;
  std::vector<bool> inside(n, false);
  std::uint32_t added = 0;
  while (tree.size() + 1 < n) {
    inside[added] = true;
    std::uint32_t next = added;
    double best = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < n; ++i) {
      if (inside[i]) continue;
      const double length = glm::distance(points[i], points[added]);
      if (length < nearest[i].length) nearest[i] = {length, added, i};
      if (nearest[i].length < best) best = nearest[i].length, next = i;
    }
    tree.push_back(nearest[next]);
    added = next;
  }
  std::sort(tree.begin(), tree.end(), [](const TreeEdge& a, const TreeEdge& b) { return a.length < b.length; });
  return tree;
}

std::vector<std::uint32_t> components(std::size_t count, std::span<const TreeEdge> edges) {
  std::vector<std::uint32_t> root(count);
  std::iota(root.begin(), root.end(), 0u);
  auto find = [&](std::uint32_t i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  for (const TreeEdge& edge : edges) root[find(edge.a)] = find(edge.b);
  std::vector<std::uint32_t> number(count, std::uint32_t(count)), component(count);
  std::uint32_t next = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    std::uint32_t& its = number[find(i)];
    if (its == count) its = next++;
    component[i] = its;
  }
  return component;
}

std::vector<std::uint32_t> findCaptureSites(std::span<const Camera> cameras) {
  const std::size_t n = cameras.size();
  std::vector<std::uint32_t> own(n);
  std::iota(own.begin(), own.end(), 0u);
  if (n < 2) return own;
  std::vector<glm::dvec3> positions;
  for (const Camera& camera : cameras) positions.push_back(camera.pose.position);
  const std::vector<TreeEdge> tree = spanningTree(positions);
  // Lengths below this are rounding errors: positions are accurate to about 1e-15 of their size.
  double floor = 0;
  for (const Camera& camera : cameras) floor = std::max(floor, glm::length(camera.pose.position) * 1e-12);
  floor = std::max(floor, tree.back().length * 1e-9);
  if (tree.back().length <= floor) return std::vector<std::uint32_t>(n, 0);  // all at one point

  struct Jump {
    double ratio;
    std::size_t edges;
  };
  std::vector<Jump> jumps;
  for (std::size_t e = 1; e < tree.size(); ++e) {
    const double ratio = tree[e].length / std::max(tree[e - 1].length, floor);
    if (ratio > kMinGapRatio) jumps.push_back({ratio, e});
  }
  std::stable_sort(jumps.begin(), jumps.end(), [](const Jump& a, const Jump& b) { return a.ratio > b.ratio; });
  for (const Jump& jump : jumps) {
    const auto site = components(n, std::span(tree).first(jump.edges));
    if (areCaptureSites(cameras, site, tree[jump.edges].length)) return site;
  }
  // Photographs at exactly the same point can never span a cell, so they always share a site.
  const auto apart = std::find_if(tree.begin(), tree.end(), [&](const TreeEdge& edge) { return edge.length > floor; });
  return components(n, std::span(tree.begin(), apart));
}

}  // namespace ibr
