// SPDX-License-Identifier: Apache-2.0
#include "scene/advice/capture_facts.h"

#include <algorithm>
#include <numeric>
#include <set>
#include <utility>

namespace ibr {
namespace {

std::vector<std::vector<std::uint32_t>> cellNeighbours(const Scene& scene) {
  std::vector<std::set<std::uint32_t>> neighbours(scene.nodes.size());
  for (const Cell& cell : scene.cells)
    for (const std::uint32_t i : cell.members)
      for (const std::uint32_t j : cell.members)
        if (i != j) neighbours[i].insert(j);
  std::vector<std::vector<std::uint32_t>> lists;
  for (const auto& set : neighbours) lists.emplace_back(set.begin(), set.end());
  return lists;
}

std::vector<bool> usedNodes(const Scene& scene) {
  std::vector<bool> used(scene.nodes.size(), false);
  for (const Cell& cell : scene.cells)
    for (const std::uint32_t i : cell.members) used[i] = true;
  return used;
}

// Groups of sites that cells join: a union-find structure whose roots number the groups.
std::vector<std::uint32_t> siteGroups(const Scene& scene, const SiteGraph& siteGraph) {
  std::vector<std::uint32_t> root(siteGraph.sites.size());
  std::iota(root.begin(), root.end(), 0u);
  const auto find = [&](std::uint32_t i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  for (const Cell& cell : scene.cells)
    for (const std::uint32_t i : cell.members)
      root[find(siteGraph.siteOf[i])] = find(siteGraph.siteOf[cell.members[0]]);
  std::vector<std::uint32_t> groups(root.size());
  for (std::uint32_t site = 0; site < groups.size(); ++site) groups[site] = find(site);
  return groups;
}

}  // namespace

CaptureFacts captureFacts(const Scene& scene) {
  std::vector<DepthGrid> depths = depthGrids(scene);
  SiteGraph siteGraph = buildSiteGraph(scene, depths);
  std::vector<std::uint32_t> groups = siteGroups(scene, siteGraph);
  return {scene, std::move(depths), std::move(siteGraph), std::move(groups), usedNodes(scene), cellNeighbours(scene)};
}

bool isUsedSite(const CaptureFacts& facts, std::uint32_t site) {
  return std::ranges::any_of(facts.siteGraph.sites[site].nodes, [&](std::uint32_t n) { return facts.used[n]; });
}

}  // namespace ibr
