// SPDX-License-Identifier: Apache-2.0
#include "author/mesh.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "author/delaunay.h"
#include "author/label.h"
#include "author/ranges.h"
#include "author/vertices.h"

namespace ibr {
namespace {

constexpr double kPriorLevels = 0.5;  // standard deviation of the sweep's depth
constexpr double kNoisePx = 0.25;     // of a match

// Twice the signed area; exact enough in double for float positions that what is not clearly positive counts as folded.
double area(const std::vector<glm::vec2>& at, const glm::uvec3& t) {
  const glm::dvec2 a = glm::dvec2(at[t.y]) - glm::dvec2(at[t.x]), b = glm::dvec2(at[t.z]) - glm::dvec2(at[t.x]);
  return a.x * b.y - a.y * b.x;
}

struct Vertices : MatchedVertices {
  std::vector<std::vector<glm::vec2>> stored;  // of each member, px of its stored photograph

  Vertices(std::span<const Camera> cameras, std::span<const MatchView> views, const DenseMatch& match)
      : MatchedVertices(matchedVertices(views, match)), stored(matched) {
    for (std::size_t i = 0; i < views.size(); ++i) {
      const glm::vec2 scale(float(cameras[i].intrinsics.width) / float(views[i].picture.width),
                            float(cameras[i].intrinsics.height) / float(views[i].picture.height));
      for (glm::vec2& position : stored[i]) position *= scale;
    }
  }

  std::size_t count() const { return frame.size(); }
  std::vector<glm::uvec3> triangulate() const {
    return delaunayTriangles(std::vector<glm::dvec2>(frame.begin(), frame.end()));
  }
  bool folded(const glm::uvec3& t) const {
    constexpr double kLeast = 1e-3;  // px²
    if (!(area(frame, t) > kLeast)) return true;
    return std::any_of(stored.begin(), stored.end(),
                       [&](const auto& positions) { return !(area(positions, t) > kLeast); });
  }
  void keepOnly(const std::vector<bool>& keep) {
    ibr::keepOnly(frame, keep);
    ibr::keepOnly(inverseDepth, keep);
    for (auto& list : matched) ibr::keepOnly(list, keep);
    for (auto& list : stored) ibr::keepOnly(list, keep);
  }
};

}  // namespace

CellMesh buildMesh(std::span<const Camera> stored, std::span<const MatchView> views, const DenseMatch& match) {
  const std::size_t d = views.size();
  CellMesh result;
  MorphMesh& mesh = result.mesh;
  Vertices vertices(stored, views, match);
  const std::vector<glm::uvec3> triangles = triangulateAndRepair(vertices);
  const std::vector<TriangleLabel> labels = labelTriangles(views, match, vertices.frame, vertices.matched, triangles);

  double covered = 0, weighted = 0;
  for (const Tier tier : {kTierAgrees, kTierRejected})
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      const bool agrees = labels[t].agrees() && !vertices.folded(triangles[t]);
      if (agrees != (tier == kTierAgrees)) continue;
      mesh.triangles.push_back(triangles[t]);
      mesh.tier.push_back(tier);
      mesh.ecc.push_back(labels[t].ecc);
      if (!agrees) continue;
      const double size = 0.5 * area(vertices.frame, triangles[t]);
      covered += size;
      weighted += size * double(labels[t].ecc);
    }
  result.quality.coverage = covered / (double(match.good.width) * double(match.good.height));
  if (covered > 0) result.quality.ecc = weighted / covered;

  mesh.match = vertices.stored;
  mesh.ratio.resize(d);
  std::vector<double> residuals;
  std::vector<Camera> cameras;
  for (const MatchView& view : views) cameras.push_back(view.camera);
  for (std::size_t v = 0; v < vertices.frame.size(); ++v) {
    std::vector<glm::dvec2> pixels;
    for (std::size_t i = 0; i < d; ++i) pixels.emplace_back(vertices.matched[i][v]);
    const RangePrior prior{vertices.inverseDepth[v], kPriorLevels * double(match.inverseDepthStep)};
    const Range range = triangulate(match.frame, cameras, pixels, prior, kNoisePx);
    mesh.inverseDistance.push_back(float(range.inverseDistance));
    mesh.uncertainty.push_back(float(range.uncertainty));
    for (std::size_t i = 0; i < d; ++i) mesh.ratio[i].push_back(float(range.ratio[i]));
    residuals.push_back(range.residualPx);
  }
  if (!residuals.empty()) {
    const auto middle = residuals.begin() + std::ptrdiff_t(residuals.size() / 2);
    std::nth_element(residuals.begin(), middle, residuals.end());
    result.quality.residualPx = *middle;
  }
  return result;
}

}  // namespace ibr
