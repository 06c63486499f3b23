// SPDX-License-Identifier: Apache-2.0
#include "batch/evaluate/union_of_views.h"

#include <algorithm>

namespace ibr::app {
namespace {

constexpr double kNearShare = 0.1;
constexpr int kSpacing = 8;

double nearDistanceOf(const Scene& scene) {
  std::vector<float> inverse;
  for (const Cell& cell : scene.cells)
    inverse.insert(inverse.end(), cell.mesh.inverseDistance.begin(), cell.mesh.inverseDistance.end());
  if (inverse.empty()) return INFINITY;
  const auto at = inverse.begin() + std::ptrdiff_t((1 - kNearShare) * double(inverse.size() - 1));
  std::nth_element(inverse.begin(), at, inverse.end());
  return 1.0 / double(*at);
}

// A pinhole's image is convex, so a ray whose ends are both visible is visible in between.
bool sees(const Camera& camera, glm::dvec3 towards) {
  const auto pixel = project(camera.intrinsics, glm::conjugate(camera.pose.rotation) * towards);
  return pixel && pixel->x >= 0 && pixel->y >= 0 && pixel->x <= camera.intrinsics.width &&
         pixel->y <= camera.intrinsics.height;
}

}  // namespace

UnionOfViews::UnionOfViews(const Scene& scene) : nearDistance_(nearDistanceOf(scene)) {
  for (const Node& node : scene.nodes) cameras_.push_back(node.camera);
}

std::vector<glm::ivec2> UnionOfViews::pixelsSeen(const Camera& view) const {
  std::vector<glm::ivec2> pixels;
  for (int y = kSpacing / 2; y < view.intrinsics.height; y += kSpacing)
    for (int x = kSpacing / 2; x < view.intrinsics.width; x += kSpacing) {
      const glm::dvec3 ray = view.pose.rotation * unproject(view.intrinsics, {x + 0.5, y + 0.5});
      const glm::dvec3 nearPoint = view.pose.position + nearDistance_ * ray;
      const bool seen = std::ranges::any_of(cameras_, [&](const Camera& camera) {
        return sees(camera, ray) && (nearDistance_ == INFINITY || sees(camera, nearPoint - camera.pose.position));
      });
      if (seen) pixels.emplace_back(x, y);
    }
  return pixels;
}

}  // namespace ibr::app
