// SPDX-License-Identifier: Apache-2.0
// Views rendered by the reference implementation of Composition::gathered, from the backdrops' meshes with their
// evidence and from the depth textures.
#pragma once

#include <map>
#include <vector>

#include "ibr/renderer.h"
#include "ibr/scene.h"
#include "reference/composer.h"

namespace ibr::app {

/// Not thread-safe. Keeps the textures of a view's photographs until the next view.
class ReferenceViews {
 public:
  /// `threads` 0: all cores. Precondition: isGatherable(scene). The scene and its files must outlive this object.
  ReferenceViews(const Scene& scene, int threads);

  /// Renders a view. The vote has the view's size; magnified photographs are interpolated by cubic splines. Holes in
  /// the depth are filled from around, and so are colours that no photograph shows. Throws Error for a file that cannot
  /// be read, and as planFrame does.
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

/// True if the scene's photographs have confirmed depth.
bool isGatherable(const Scene& scene);

}  // namespace ibr::app
