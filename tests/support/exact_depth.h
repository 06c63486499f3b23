// SPDX-License-Identifier: Apache-2.0
// Exact depth of synthetic scenes; tests use it in place of matched depth.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "author/backdrop/complete_depth.h"
#include "author/depth/depth_views.h"
#include "author/depth/photograph_depth.h"
#include "lab/generate/synthetic.h"

namespace ibr::test {

/// Returns one channel: inverse depth along the camera's axis at pixel centres, 0 where there is no surface.
inline ImageF exactInverseDepth(const SyntheticScene& scene, const Camera& camera) {
  ImageF map = renderDepth(scene, camera);
  for (float& value : map.values) value = 1 / value;
  return map;
}

inline std::vector<Camera> camerasOf(const Scene& scene) {
  std::vector<Camera> cameras;
  for (const Node& node : scene.nodes) cameras.push_back(node.camera);
  return cameras;
}

/// Returns exact matches of the photographs `of` (of a panorama: of its faces); the other photographs have no matches.
/// Depth is unknown where there is no surface. The scene must outlive the result.
inline DepthMatches exactMatches(const SyntheticScene& scene, std::set<std::uint32_t> of) {
  return [&scene, of = std::move(of), views = depthViews(camerasOf(scene.scene))](std::size_t view) {
    std::optional<SweptDepth> match;
    if (!of.contains(views[view].node)) return match;
    ImageF depth = exactInverseDepth(scene, views[view].camera);
    for (float& value : depth.values)
      if (value == 0) value = kUnknownDepth;
    const Image8 sky(depth.width, depth.height, 1, 0);
    match.emplace(SweptDepth{std::move(depth), sky});
    return match;
  };
}

}  // namespace ibr::test
