// SPDX-License-Identifier: Apache-2.0
#include "author/graph/view_groups.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numeric>
#include <set>

#include "author/graph/capture_sites.h"

namespace ibr {
namespace {

constexpr std::size_t kRequiredNeighbours = 12;  // nearest sites that must be in a group with a view
constexpr double kMinBridgeRatio = 8.0;          // tree edges longer than this, in median edges, lead to distant parts
constexpr std::size_t kMinPartSize = 4;          // min views of a part with its own rank
constexpr double kMinPartsShare = 0.8;           // min share of a group in parts of that size

// Symmetric: the smaller θ decides.
bool hasSimilarAxis(const Views& views, std::uint32_t a, std::uint32_t b) {
  if (!views.sameKind(a, b)) return false;
  return a == b || axisAngle(views, a, b) <= std::min(views[a].theta, views[b].theta);
}

ViewGroup groupAround(const Views& views, std::uint32_t seed) {
  std::map<std::uint32_t, std::pair<double, std::uint32_t>> best;  // for each site: angle, view
  for (std::uint32_t i = 0; i < views.size(); ++i) {
    if (!hasSimilarAxis(views, seed, i)) continue;
    const std::pair choice(i == seed ? -1.0 : axisAngle(views, seed, i), i);
    const auto [at, added] = best.emplace(views[i].site, choice);
    if (!added) at->second = std::min(at->second, choice);
  }
  ViewGroup group;
  for (const auto& [site, choice] : best) group.push_back(choice.second);
  std::sort(group.begin(), group.end());
  return group;
}

// The kRequiredNeighbours nearest views of a group, and the view itself.
ViewGroup around(const Views& views, const ViewGroup& group, std::uint32_t seed) {
  const glm::dvec3 centre = views.siteCentre[views[seed].site];
  std::vector<std::pair<double, std::uint32_t>> near;
  for (const std::uint32_t i : group) {
    const glm::dvec3 offset = views.siteCentre[views[i].site] - centre;
    near.emplace_back(glm::dot(offset, offset), i);
  }
  const std::size_t count = std::min(near.size(), kRequiredNeighbours + 1);
  std::partial_sort(near.begin(), near.begin() + std::ptrdiff_t(count), near.end());
  ViewGroup nearest;
  for (std::size_t k = 0; k < count; ++k) nearest.push_back(near[k].second);
  std::sort(nearest.begin(), nearest.end());
  return nearest;
}

}  // namespace

std::vector<ViewGroup> orientationGroups(const Views& views) {
  std::vector<ViewGroup> surroundings;
  std::vector<std::pair<std::ptrdiff_t, std::uint32_t>> seeds;  // −size, view: largest groups first, then by name
  for (std::uint32_t i = 0; i < views.size(); ++i) {
    const ViewGroup group = groupAround(views, i);
    surroundings.push_back(around(views, group, i));
    seeds.emplace_back(-std::ptrdiff_t(group.size()), i);
  }
  std::sort(seeds.begin(), seeds.end());
  std::set<ViewGroup> groups;
  std::vector<bool> served(views.size(), false);
  for (const auto& [size, seed] : seeds) {
    if (served[seed]) continue;
    const ViewGroup group = groupAround(views, seed);
    for (const std::uint32_t i : group)
      if (std::includes(group.begin(), group.end(), surroundings[i].begin(), surroundings[i].end())) served[i] = true;
    if (group.size() >= 2) groups.insert(group);
  }
  return {groups.begin(), groups.end()};
}

std::vector<ViewGroup> partsOf(const Views& views, const ViewGroup& group) {
  const std::vector<glm::dvec3> positions = siteCentresOf(views, group);
  if (views.lattice || findLattice(positions)) return {group};
  const std::vector<TreeEdge> tree = spanningTree(positions);
  const double limit = kMinBridgeRatio * tree[tree.size() / 2].length;
  const auto bridges =
      std::find_if(tree.begin(), tree.end(), [&](const TreeEdge& edge) { return edge.length > limit; });
  if (bridges == tree.end()) return {group};
  const auto part = components(group.size(), std::span(tree.begin(), bridges));
  std::vector<ViewGroup> parts(1 + *std::max_element(part.begin(), part.end()));
  for (std::size_t k = 0; k < group.size(); ++k) parts[part[k]].push_back(group[k]);
  std::size_t held = 0;
  for (const ViewGroup& its : parts) held += its.size() >= kMinPartSize ? its.size() : 0;
  if (double(held) < kMinPartsShare * double(group.size())) return {group};
  for (auto edge = bridges; edge != tree.end(); ++edge)
    parts.push_back({std::min(group[edge->a], group[edge->b]), std::max(group[edge->a], group[edge->b])});
  std::erase_if(parts, [](const ViewGroup& its) { return its.size() < 2; });
  return parts;
}

}  // namespace ibr
