// SPDX-License-Identifier: Apache-2.0
#include "author/depth/photograph_depth.h"

#include <algorithm>
#include <cmath>

#include "author/backdrop/backdrop.h"
#include "author/backdrop/complete_depth.h"
#include "author/backdrop/scene_depth.h"
#include "author/sweep/depth_clean.h"
#include "base/check.h"
#include "base/median.h"
#include "scene/capture_spacing.h"

namespace ibr {
namespace {

constexpr double kStepPx = 2;  // of a photograph: 1 px at half its size

void runInTurn(std::size_t count, const std::function<void(std::size_t)>& job) {
  for (std::size_t i = 0; i < count; ++i) job(i);
}

bool isSky(const PhotographDepth& depth, std::size_t pixel) {
  return !depth.sky.empty() && depth.sky.values[pixel];
}

// Where it is not kept: kUnknownDepth.
ImageF keptDepth(const PhotographDepth& depth) {
  constexpr float kSurfaceSteps = 2;  // between neighbours of one surface
  ImageF kept = depth.matched.map.inverseDepth;
  const DepthEvidence& evidence = depth.evidence;
  for (std::size_t p = 0; p < kept.values.size(); ++p) {
    const int c = evidence.confirmations.values[p], v = evidence.contradictions.values[p];
    const bool believed = c >= 2 || (c == 1 && v == 0) || evidence.witnesses.values[p] == 0 || isSky(depth, p);
    if (!believed) kept.values[p] = kUnknownDepth;
  }
  if (depth.sparse) return kept;
  const std::vector<bool> speckle = speckles(kept, kSurfaceSteps * float(depth.matched.step), kLeastSurface);
  for (std::size_t p = 0; p < kept.values.size(); ++p)
    if (speckle[p]) kept.values[p] = kUnknownDepth;
  return kept;
}

int nearestPixel(double at, int side) {
  return std::clamp(int(std::floor(at)), 0, side - 1);
}

}  // namespace

double medianResidualPx(const Scene& scene) {
  std::vector<double> residuals;
  for (const Cell& cell : scene.cells) residuals.push_back(cell.quality.residualPx);
  const double middle = median(std::move(residuals));
  return std::isfinite(middle) ? middle : 0;
}

std::vector<PhotographDepth> depthOfPhotographs(const Scene& scene, const PhotographDepthOptions& options) {
  std::vector<PhotographDepth> result;
  std::vector<Camera> cameras;
  for (std::uint32_t n = 0; n < scene.nodes.size(); ++n)
    if (const Camera& camera = scene.nodes[n].camera; camera.intrinsics.model == CameraModel::pinhole) {
      result.push_back({.node = n});
      cameras.push_back(camera);
    }
  if (result.empty()) return result;
  std::vector<bool> inCell(scene.nodes.size(), false);
  for (const Cell& cell : scene.cells)
    for (const std::uint32_t member : cell.members) inCell[member] = true;
  const double spacing = captureSpacing(cameras), residualPx = medianResidualPx(scene);
  std::vector<ConsistentDepth> matched(result.size());
  const JobRunner runDepths = options.depths ? options.depths : runInTurn,
                  runEvidence = options.evidence ? options.evidence : runInTurn;
  runDepths(result.size(), [&](std::size_t i) {
    const std::uint32_t node = result[i].node;
    const Intrinsics& stored = cameras[i].intrinsics;
    glm::ivec2 size = backdropSize(stored);
    std::optional<SweptDepth> swept;
    if (options.matches) swept = options.matches(node);
    if (swept) size = {swept->sky.width, swept->sky.height};
    const Camera small{resized(stored, size.x, size.y), cameras[i].pose};
    ImageF depth;
    if (swept) {
      depth = std::move(swept->inverseDepth);
      result[i].sky = std::move(swept->sky);
    } else if (inCell[node]) {
      depth = depthInScene(scene, node, size);
    } else {
      result[i].sparse = true;
      depth = depthOfPoints(small, options.points ? options.points(node) : std::vector<glm::dvec3>{});
    }
    matched[i] = {{small, std::move(depth)}, kStepPx / (stored.fx * spacing), residualPx * size.x / stored.width};
  });
  std::vector<DepthEvidence> evidence = depthEvidence(matched, kDepthSources, runEvidence);
  for (std::size_t i = 0; i < result.size(); ++i) {
    result[i].matched = std::move(matched[i]);
    result[i].evidence = std::move(evidence[i]);
  }
  return result;
}

CompletedDepth completed(const PhotographDepth& depth, const Image8& colours) {
  constexpr int kSkyConfirmations = 2;
  ImageF kept = keptDepth(depth);
  const int width = kept.width, height = kept.height;
  CompletedDepth result{
      {completeDepth(kept, colours), ImageF(width, height, 1, kCompletedConsensus)}, {}, Image8(width, height, 1, 0)};
  for (std::size_t p = 0; p < kept.values.size(); ++p) {
    if (kept.values[p] < 0) continue;
    const bool sky = isSky(depth, p);
    const int c = sky ? kSkyConfirmations : depth.evidence.confirmations.values[p];
    const int v = sky ? 0 : depth.evidence.contradictions.values[p];
    result.confirmations.values[p] = std::uint8_t(c);
    result.maps.consensus.values[p] = float((c + 0.25) / (c + v + 0.5));
  }
  result.kept = std::move(kept);
  return result;
}

void addEvidence(MorphMesh& mesh, const Intrinsics& stored, const CompletedDepth& depth) {
  check(mesh.memberCount() == 1, ErrorCode::invalidInput, "evidence is added to backdrops, not to a mesh of {} members",
        mesh.memberCount());
  const Image8& counts = depth.confirmations;
  mesh.confirmations.clear();
  mesh.consensus.clear();
  for (const glm::vec2 match : mesh.match[0]) {
    const int x = nearestPixel(double(match.x) * counts.width / stored.width, counts.width),
              y = nearestPixel(double(match.y) * counts.height / stored.height, counts.height);
    mesh.confirmations.push_back(counts.pixel(x, y)[0]);
    mesh.consensus.push_back(depth.maps.consensus.pixel(x, y)[0]);
  }
}

}  // namespace ibr
