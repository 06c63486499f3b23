// SPDX-License-Identifier: Apache-2.0
#include "scene/advice/site_graph.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <set>

namespace ibr {
namespace {

constexpr double kSameSite = 0.003;  // radians of shift
constexpr double kRounding = 1e-9;   // of the capture's extent

double extentOf(const Scene& scene) {
  if (scene.nodes.empty()) return 0;
  glm::dvec3 low = scene.nodes[0].camera.pose.position, high = low;
  for (const Node& node : scene.nodes) {
    low = glm::min(low, node.camera.pose.position);
    high = glm::max(high, node.camera.pose.position);
  }
  return glm::length(high - low);
}

std::vector<std::uint32_t> rootsOf(const Scene& scene, const std::vector<DepthGrid>& depths) {
  const std::size_t n = scene.nodes.size();
  std::vector<double> nearest;
  for (const DepthGrid& depth : depths)
    if (depth.near > 0) nearest.push_back(depth.near);
  double least = kRounding * extentOf(scene);
  if (!nearest.empty()) {
    std::ranges::nth_element(nearest, nearest.begin() + std::ptrdiff_t(nearest.size() / 2));
    least = std::max(least, kSameSite / nearest[nearest.size() / 2]);
  }
  std::vector<std::uint32_t> root(n);
  std::iota(root.begin(), root.end(), 0u);
  const auto find = [&](std::uint32_t i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < i; ++j) {
      const double apart = glm::distance(scene.nodes[i].camera.pose.position, scene.nodes[j].camera.pose.position);
      if (apart <= least) root[find(i)] = find(j);
    }
  for (std::uint32_t i = 0; i < n; ++i) root[i] = find(i);
  return root;
}

// The nearest few sites of each site, for a fast test: a site between two others is usually among these.
std::vector<std::vector<std::uint32_t>> nearestOf(const std::vector<CaptureSite>& sites) {
  constexpr std::size_t kFew = 12;
  std::vector<std::vector<std::uint32_t>> nearest(sites.size());
  std::vector<std::uint32_t> others(sites.size());
  for (std::uint32_t a = 0; a < sites.size(); ++a) {
    std::iota(others.begin(), others.end(), 0u);
    const std::size_t few = std::min(kFew, others.size());
    std::ranges::partial_sort(others, others.begin() + std::ptrdiff_t(few), {},
                              [&](std::uint32_t b) { return glm::distance(sites[a].position, sites[b].position); });
    nearest[a].assign(others.begin(), others.begin() + std::ptrdiff_t(few));
  }
  return nearest;
}

void findLinks(const Scene& scene, SiteGraph& found) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> joined;
  for (const Cell& cell : scene.cells)
    for (const std::uint32_t i : cell.members)
      for (const std::uint32_t j : cell.members) joined.insert(std::minmax(found.siteOf[i], found.siteOf[j]));
  auto& sites = found.sites;
  const auto nearest = nearestOf(sites);
  std::vector<double> lengths;
  for (std::uint32_t a = 0; a < sites.size(); ++a)
    for (std::uint32_t b = a + 1; b < sites.size(); ++b) {
      const double length = glm::distance(sites[a].position, sites[b].position), limit = length * (1 - 1e-9);
      const auto between = [&](const CaptureSite& p) {
        return glm::distance(p.position, sites[a].position) < limit &&
               glm::distance(p.position, sites[b].position) < limit;
      };
      const auto numbered = [&](std::uint32_t p) { return between(sites[p]); };
      if (std::ranges::any_of(nearest[a], numbered) || std::ranges::any_of(sites, between)) continue;
      found.links.push_back({a, b, length, joined.contains({a, b})});
      sites[a].beside.push_back(b);
      sites[b].beside.push_back(a);
      lengths.push_back(length);
    }
  for (CaptureSite& site : sites) std::ranges::sort(site.beside);
  if (lengths.empty()) return;
  std::ranges::nth_element(lengths, lengths.begin() + std::ptrdiff_t(lengths.size() / 2));
  found.step = lengths[lengths.size() / 2];
  found.row = std::ranges::none_of(scene.cells, [&](const Cell& cell) {
    std::set<std::uint32_t> spanned;
    for (const std::uint32_t i : cell.members) spanned.insert(found.siteOf[i]);
    return spanned.size() > 2;
  });
}

}  // namespace

SiteGraph buildSiteGraph(const Scene& scene, const std::vector<DepthGrid>& depths) {
  SiteGraph found;
  const std::vector<std::uint32_t> root = rootsOf(scene, depths);
  std::vector<std::uint32_t> byName(root.size());
  std::iota(byName.begin(), byName.end(), 0u);
  std::ranges::sort(byName, {}, [&](std::uint32_t i) -> const std::string& { return scene.nodes[i].name; });
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> number(root.size(), kNone);
  found.siteOf.resize(root.size());
  for (const std::uint32_t i : byName) {
    std::uint32_t& its = number[root[i]];
    if (its == kNone) {
      its = std::uint32_t(found.sites.size());
      found.sites.emplace_back();
    }
    found.siteOf[i] = its;
    found.sites[its].nodes.push_back(i);
  }
  for (CaptureSite& site : found.sites)
    for (const std::uint32_t i : site.nodes)
      site.position += scene.nodes[i].camera.pose.position / double(site.nodes.size());
  findLinks(scene, found);
  return found;
}

}  // namespace ibr
