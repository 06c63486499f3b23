// SPDX-License-Identifier: Apache-2.0
#include "author/depth/photograph_depth.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "base/median.h"
#include "scene/capture_spacing.h"

namespace ibr {
namespace {

constexpr double kStepPx = 2;  // px of the photograph: 1 px at half its size
constexpr float kCompletedConsensus = 0.1f;

}  // namespace

std::vector<ConsistentDepth> consistentDepths(std::span<const Camera> cameras, std::vector<ImageF> known,
                                              double residualPx) {
  assert(cameras.size() == known.size());
  if (cameras.empty()) return {};
  const double spacing = captureSpacing({cameras.begin(), cameras.end()});
  std::vector<ConsistentDepth> result;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const Intrinsics& stored = cameras[i].intrinsics;
    Camera camera = cameras[i];
    camera.intrinsics = resized(stored, known[i].width, known[i].height);
    const double scale = double(known[i].width) / stored.width;
    result.push_back({{camera, std::move(known[i])}, kStepPx / (stored.fx * spacing), residualPx * scale});
  }
  return result;
}

double medianResidual(const Scene& scene) {
  std::vector<double> residuals;
  for (const Cell& cell : scene.cells) residuals.push_back(cell.quality.residualPx);
  const double middle = residuals.empty() ? 0 : median(std::move(residuals));
  return std::isfinite(middle) ? middle : 0;
}

ImageF consensusOf(const ImageF& known, const DepthEvidence& evidence) {
  ImageF result(known.width, known.height, 1);
  for (std::size_t p = 0; p < known.values.size(); ++p) {
    const double c = evidence.confirmations.values[p], v = evidence.contradictions.values[p];
    result.values[p] = known.values[p] < 0 ? kCompletedConsensus : float((c + 0.25) / (c + v + 0.5));
  }
  return result;
}

void addEvidence(MorphMesh& mesh, const Camera& stored, const ImageF& known, const DepthEvidence& evidence) {
  const ImageF consensus = consensusOf(known, evidence);
  const glm::dvec2 scale(double(known.width) / stored.intrinsics.width,
                         double(known.height) / stored.intrinsics.height);
  mesh.confirmations.clear();
  mesh.consensus.clear();
  for (const glm::vec2& match : mesh.match[0]) {
    const int x = std::clamp(int(double(match.x) * scale.x), 0, known.width - 1),
              y = std::clamp(int(double(match.y) * scale.y), 0, known.height - 1);
    mesh.confirmations.push_back(known.pixel(x, y)[0] < 0 ? std::uint8_t(0) : evidence.confirmations.pixel(x, y)[0]);
    mesh.consensus.push_back(consensus.pixel(x, y)[0]);
  }
}

}  // namespace ibr
