// SPDX-License-Identifier: Apache-2.0
#include "render/photographs/photograph_choice.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <span>

#include "base/median.h"
#include "render/photographs/photograph_set.h"
#include "render/photographs/photograph_values.h"
#include "scene/capture_spacing.h"

namespace ibr {
namespace {

struct Evaluated {
  PhotographIndex::Photograph photograph;
  SampleValues values;
  float alone = 0;      // coverage
  double distance = 0;  // from the middle of the views, world units
};

}  // namespace

std::vector<std::uint32_t> gatherableBackdrops(const Scene& scene) {
  std::vector<std::uint32_t> result;
  for (std::uint32_t b = 0; b < scene.backdrops.size(); ++b) {
    const Cell& backdrop = scene.backdrops[b];
    if (!backdrop.mesh.confirmations.empty() && !scene.nodes[backdrop.members[0]].depthFile.empty())
      result.push_back(b);
  }
  return result;
}

void choosePhotographs(const Scene& scene, const PhotographIndex& index, const GatherStatistics& statistics,
                       const std::vector<Camera>& views, const Pose& middle, std::size_t count,
                       std::pmr::memory_resource* memory, std::vector<PlannedPhotograph>& chosen) {
  chosen.clear();
  const SampleRays rays = sampleRays(views, middle);
  std::pmr::vector<Evaluated> evaluated(memory);
  const auto promising =
      promisingPhotographs(index, views, middle, statistics.medianInverseDepth, kMaxPromising, memory);
  evaluated.reserve(promising.size());
  for (const PhotographIndex::Photograph& photograph : promising) {
    const Camera& camera = scene.nodes[photograph.node].camera;
    Evaluated& one = evaluated.emplace_back();
    one.photograph = photograph;
    one.values = photographValues(camera, middle, rays, statistics.medianInverseDepth);
    one.alone = coverage(one.values);
    one.distance = glm::distance(camera.pose.position, middle.position);
    if (!(one.alone > 0)) evaluated.pop_back();
  }
  std::pmr::vector<const Evaluated*> pool(memory);
  for (const Evaluated& one : evaluated) pool.push_back(&one);
  std::ranges::sort(pool, [](const Evaluated* a, const Evaluated* b) {
    return a->alone != b->alone ? a->alone > b->alone : a->photograph.backdrop < b->photograph.backdrop;
  });
  pool.resize(std::min(pool.size(), kMaxPoolSize));

  std::pmr::vector<const SampleValues*> values(memory);
  for (const Evaluated* one : pool) values.push_back(&one->values);
  const std::pmr::vector<SetMember> members = bestSet(values, count, memory);
  std::pmr::vector<SampleValues> weights(memory);
  std::pmr::vector<double> shares(members.size(), memory);
  for (const SetMember& member : members) {
    weights.push_back(*values[member.photograph]);
    toGatherWeights(weights.back(), pool[member.photograph]->distance / statistics.spacing, member.weight);
  }
  gatherShares(weights, shares);
  const double total = std::accumulate(shares.begin(), shares.end(), 0.0);
  for (std::size_t m = 0; m < members.size(); ++m) {
    const Evaluated& one = *pool[members[m].photograph];
    chosen.push_back({one.photograph.node, one.photograph.backdrop, double(members[m].weight), one.distance,
                      total > 0 ? shares[m] / total : 1 / double(members.size())});
  }
}

GatherStatistics gatherStatistics(const Scene& scene, const std::stop_token& stop) {
  GatherStatistics bounds;
  std::vector<Camera> cameras;
  for (const Node& node : scene.nodes) cameras.push_back(node.camera);
  if (!cameras.empty()) bounds.spacing = captureSpacing(cameras, stop);
  std::vector<double> confirmed, residuals;
  for (const Cell& backdrop : scene.backdrops)
    for (std::size_t p = 0; p < backdrop.mesh.confirmations.size(); ++p)
      if (backdrop.mesh.confirmations[p] > 0) confirmed.push_back(double(backdrop.mesh.inverseDistance[p]));
  if (!confirmed.empty()) bounds.medianInverseDepth = median(std::move(confirmed));
  for (const Cell& cell : scene.cells)
    if (std::isfinite(cell.quality.residualPx)) residuals.push_back(cell.quality.residualPx);
  if (!residuals.empty()) bounds.residualPx = median(std::move(residuals));
  return bounds;
}

}  // namespace ibr
