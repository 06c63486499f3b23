// SPDX-License-Identifier: Apache-2.0
// Views that the reference composer makes of a scene as Composition::gathered does: from the backdrops' meshes, with
// their evidence, and the depth textures.
#pragma once

#include <map>
#include <vector>

#include "ibr/renderer.h"
#include "ibr/scene.h"
#include "reference/composer.h"

namespace ibr::app {

/// One thread at a time. Keeps the textures of a view's photographs until the next view.
class ReferenceViews {
 public:
  /// `threads` 0: all cores. Precondition: isGatherable(scene). The scene and its files must outlive it.
  ReferenceViews(const Scene& scene, int threads);

  /// The vote has the view's size, and photographs that are magnified are read by cubic splines. Where it has no depth,
  /// that is filled from around, and where no photograph shows what lies there, its colour is. Throws Error for a file
  /// that cannot be read, and as planFrame does.
  reference::Composed compose(const Camera& view, Exposure exposure);

 private:
  struct Textures {
    std::vector<Image8> levels;
    ImageF depth;  // ρ / depthScale, consensus
  };
  void take(const std::vector<PlannedPhotograph>& photographs);

  const Scene& scene_;
  int threads_;
  SceneBounds bounds_;
  std::map<std::uint32_t, Textures> textures_;  // by node
};

/// Whether photographs have evidence of their depth.
bool isGatherable(const Scene& scene);

}  // namespace ibr::app
