// SPDX-License-Identifier: Apache-2.0
#include "author/mesh.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "author/delaunay.h"
#include "author/label.h"
#include "author/quadtree.h"
#include "author/ranges.h"
#include "author/refine_depth.h"

namespace ibr {
namespace {

constexpr int kRepairs = 30;          // passes at most; what still folds over is not tier 0
constexpr double kPriorLevels = 0.5;  // standard deviation of the sweep's depth
constexpr double kNoisePx = 0.25;     // of a match

// Twice the signed area; exact enough in double for float positions that what is not clearly positive counts as folded.
double area(const std::vector<glm::vec2>& at, const glm::uvec3& t) {
  const glm::dvec2 a = glm::dvec2(at[t.y]) - glm::dvec2(at[t.x]), b = glm::dvec2(at[t.z]) - glm::dvec2(at[t.x]);
  return a.x * b.y - a.y * b.x;
}

struct Vertices {
  std::vector<glm::vec2> frame;                 // px of the mean frame
  std::vector<double> inverseDepth;             // along its axis
  std::vector<std::vector<glm::vec2>> matched;  // of each view, px of its picture
  std::vector<std::vector<glm::vec2>> stored;   // of each member, px of its stored photograph

  template <class Keep>
  void filter(Keep&& keep) {
    auto apply = [&](auto& list) {
      std::size_t kept = 0;
      for (std::size_t v = 0; v < list.size(); ++v)
        if (keep(v)) list[kept++] = list[v];
      list.resize(kept);
    };
    apply(frame);
    apply(inverseDepth);
    for (auto& list : matched) apply(list);
    for (auto& list : stored) apply(list);
  }
};

Vertices pickVertices(std::span<const Camera> stored, std::span<const MatchView> views, const DenseMatch& match) {
  Vertices vertices;
  vertices.matched.resize(views.size());
  vertices.stored.resize(views.size());
  const DepthRefiner refiner(views, match);
  for (const glm::ivec2 pixel : meshVertices(match)) {
    const glm::dvec2 centre = glm::dvec2(pixel) + 0.5;
    vertices.frame.emplace_back(centre);
    vertices.inverseDepth.push_back(match.refined ? double(match.inverseDepth.pixel(pixel.x, pixel.y)[0])
                                                  : refiner.at(pixel.x, pixel.y));
    for (std::size_t i = 0; i < views.size(); ++i) {
      const auto dense = match.position[i].pixel(pixel.x, pixel.y);
      glm::dvec2 position(dense[0], dense[1]);
      if (!match.refined)
        if (const auto exact = refiner.maps()[i](centre, vertices.inverseDepth.back())) position = *exact;
      const glm::dvec2 scale(double(stored[i].intrinsics.width) / views[i].picture.width,
                             double(stored[i].intrinsics.height) / views[i].picture.height);
      vertices.matched[i].emplace_back(position);
      vertices.stored[i].emplace_back(position * scale);
    }
  }
  return vertices;
}

bool folded(const Vertices& vertices, const glm::uvec3& t) {
  constexpr double kLeast = 1e-3;  // px²
  if (!(area(vertices.frame, t) > kLeast)) return true;
  return std::any_of(vertices.stored.begin(), vertices.stored.end(),
                     [&](const auto& positions) { return !(area(positions, t) > kLeast); });
}

std::vector<glm::uvec3> triangulateAndRepair(Vertices& vertices) {
  for (int pass = 0;; ++pass) {
    const std::vector<glm::dvec2> frame(vertices.frame.begin(), vertices.frame.end());
    std::vector<glm::uvec3> triangles = delaunayTriangles(frame);
    if (pass == kRepairs) return triangles;
    std::vector<unsigned> folds(vertices.frame.size(), 0);
    std::vector<glm::uvec3> bad;
    for (const glm::uvec3& t : triangles)
      if (folded(vertices, t)) {
        bad.push_back(t);
        for (int k = 0; k < 3; ++k) ++folds[t[k]];
      }
    if (bad.empty()) return triangles;
    std::vector<bool> drop(vertices.frame.size(), false);
    for (const glm::uvec3& t : bad) {
      if (drop[t.x] || drop[t.y] || drop[t.z]) continue;
      unsigned worst = t.x;
      for (int k = 1; k < 3; ++k)
        if (folds[t[k]] > folds[worst]) worst = t[k];
      drop[worst] = true;
    }
    vertices.filter([&](std::size_t v) { return !drop[v]; });
  }
}

}  // namespace

CellMesh buildMesh(std::span<const Camera> stored, std::span<const MatchView> views, const DenseMatch& match) {
  const std::size_t d = views.size();
  CellMesh result;
  MorphMesh& mesh = result.mesh;
  Vertices vertices = pickVertices(stored, views, match);
  const std::vector<glm::uvec3> triangles = triangulateAndRepair(vertices);
  const std::vector<TriangleLabel> labels = labelTriangles(views, match, vertices.frame, vertices.matched, triangles);

  double covered = 0, weighted = 0;
  for (const Tier tier : {kTierAgrees, kTierRejected})
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      const bool agrees = labels[t].agrees() && !folded(vertices, triangles[t]);
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
