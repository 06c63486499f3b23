// SPDX-License-Identifier: Apache-2.0
#include "author/scene_depth.h"

#include <algorithm>
#include <vector>

#include "author/complete_depth.h"
#include "author/own_depth.h"
#include "author/raster.h"

namespace ibr {
namespace {

// Inverse depth is linear over the picture of a flat triangle.
ImageF depthInCell(const Cell& cell, std::size_t member, const Intrinsics& stored, glm::ivec2 size) {
  const MorphMesh& mesh = cell.mesh;
  const glm::dvec2 scale(double(size.x) / stored.width, double(size.y) / stored.height);
  std::vector<double> inverseDepth(mesh.pointCount());
  for (std::size_t p = 0; p < inverseDepth.size(); ++p)
    inverseDepth[p] = double(mesh.inverseDistance[p]) /
                      (double(mesh.ratio[member][p]) * -unproject(stored, glm::dvec2(mesh.match[member][p])).z);
  ImageF depth(size.x, size.y, 1, kUnknownDepth);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.tier[t] != kTierAgrees) continue;
    const glm::uvec3 corner = mesh.triangles[t];
    const auto at = [&](int k) { return scale * glm::dvec2(mesh.match[member][corner[k]]); };
    forPixelsIn(at(0), at(1), at(2), size.x, size.y, [&](int x, int y, const glm::dvec3& weights) {
      double w = 0;
      for (int k = 0; k < 3; ++k) w += weights[k] * inverseDepth[corner[k]];
      float& value = depth.pixel(x, y)[0];
      value = std::max(value, float(std::max(w, 0.0)));
    });
  }
  return depth;
}

}  // namespace

ImageF depthInScene(const Scene& scene, std::uint32_t node, glm::ivec2 size) {
  std::vector<ImageF> maps;
  for (const Cell& cell : scene.cells) {
    const auto found = std::find(cell.members.begin(), cell.members.end(), node);
    if (found != cell.members.end())
      maps.push_back(depthInCell(cell, std::size_t(found - cell.members.begin()), scene.nodes[node].camera.intrinsics,
                                 size));
  }
  return maps.empty() ? ImageF(size.x, size.y, 1, kUnknownDepth) : medianDepth(maps);
}

}  // namespace ibr
