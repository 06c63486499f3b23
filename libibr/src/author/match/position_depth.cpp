// SPDX-License-Identifier: Apache-2.0
#include "author/match/position_depth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

namespace ibr {
namespace {

constexpr double kNoParallax = 1e-9;  // of a unit of inverse depth, relative to the members' focal lengths

}  // namespace

PositionDepth positionDepth(std::span<const FrameToMember> maps, glm::dvec2 pixel,
                            std::span<const glm::dvec2> positions) {
  double slopes = 0, sides = 0, scale = 0;
  for (std::size_t i = 0; i < maps.size(); ++i) {
    // Position p means a·(x, y, 1) + w·b ∝ (p, 1): two equations that are linear in w.
    const glm::dvec3 infinite = maps[i].homogeneous(pixel, 0);
    if (!(infinite.z > 0)) continue;
    const glm::dvec2 slope = (glm::dvec2(maps[i].b) - positions[i] * maps[i].b.z) / infinite.z;
    const glm::dvec2 side = positions[i] - glm::dvec2(infinite) / infinite.z;
    slopes += glm::dot(slope, slope);
    sides += glm::dot(slope, side);
    scale = std::max(scale, glm::length(glm::dvec2(infinite)) / infinite.z);
  }
  if (!(std::sqrt(slopes) > kNoParallax * scale)) return {};
  return {std::max(sides / slopes, 0.0), std::sqrt(slopes)};
}

void depthFromPositions(DenseMatch& match, std::span<const Camera> cameras) {
  const int width = match.frame.intrinsics.width, height = match.frame.intrinsics.height;
  std::vector<FrameToMember> maps;
  for (const Camera& camera : cameras) maps.push_back(frameToMember(match.frame, camera));
  match.inverseDepth = ImageF(width, height, 1);
  std::vector<double> motions;
  std::array<glm::dvec2, kMaxMembers> positions;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (!match.good.pixel(x, y)[0]) continue;
      for (std::size_t i = 0; i < maps.size(); ++i) {
        const auto at = match.position[i].pixel(x, y);
        positions[i] = {at[0], at[1]};
      }
      const PositionDepth found = positionDepth(maps, {x + 0.5, y + 0.5}, {positions.data(), maps.size()});
      match.inverseDepth.pixel(x, y)[0] = float(found.inverseDepth);
      if (found.motion > 0) motions.push_back(found.motion);
    }
  match.inverseDepthStep = 1;
  if (motions.empty()) return;
  const auto middle = motions.begin() + std::ptrdiff_t(motions.size() / 2);
  std::nth_element(motions.begin(), middle, motions.end());
  match.inverseDepthStep = float(1.0 / *middle);
}

}  // namespace ibr
