// SPDX-License-Identifier: Apache-2.0
#include "author/htm/htm_evaluate.h"

#include <cmath>
#include <numeric>

namespace ibr {
namespace {

// Projected area, px²; 0 if a corner is not in front of the camera.
double areaIn(const PinholeView& view, const TriangleMesh& mesh, const glm::uvec3& face) {
  const auto a = view.seen(mesh.positions[face.x]), b = view.seen(mesh.positions[face.y]),
             c = view.seen(mesh.positions[face.z]);
  if (!a || !b || !c) return 0;
  const glm::dvec2 ab = b->pixel - a->pixel, ac = c->pixel - a->pixel;
  return 0.5 * std::abs(ab.x * ac.y - ab.y * ac.x);
}

}  // namespace

EvaluatedFaces evaluateFaces(const TriangleMesh& mesh, std::span<const ProjectedMesh> views,
                             std::span<const FaceVisibility> visibility, std::span<const double> differences,
                             const EvaluateOptions& options) {
  const std::size_t n = mesh.triangles.size();
  EvaluatedFaces result{std::vector<std::uint8_t>(n, 0), 0, 0};
  const double sum = std::accumulate(differences.begin(), differences.end(), 0.0);
  const bool apart = sum > options.meanDifference * double(n);
  for (std::size_t f = 0; f < n; ++f) {
    const bool different = apart && differences[f] > options.faceDifference;
    const bool hidden = options.selfOccluded && visibility[f].partly != 0;
    if (!different && !hidden) continue;
    bool large = false;
    for (std::size_t i = 0; i < views.size() && !large; ++i)
      large = (visibility[f].seen >> i & 1) && areaIn(views[i].view, mesh, mesh.triangles[f]) >= options.minFacePx;
    if (!large) continue;
    result.divide[f] = 1;
    ++result.divided;
    result.hidden += !different;
  }
  return result;
}

}  // namespace ibr
