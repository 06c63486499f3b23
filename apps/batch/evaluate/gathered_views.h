// SPDX-License-Identifier: Apache-2.0
// Views that the reference composer makes from a scene's photographs and the depth that its cells have found, of scenes
// whose photographs have no depth of their own.
#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <optional>

#include "ibr/scene.h"
#include "reference/composer.h"

namespace ibr::app {

/// One thread at a time. Panoramas take part as six faces of a cube. Keeps photographs, or their faces, in memory, and
/// 14 bytes a pixel of depth maps of at most 512 × 512 px.
class GatheredViews {
 public:
  /// Depth of every photograph, completed, and what photographs confirm of each other's. `threads` 0: all cores. The
  /// scene and its stored photographs must outlive it. Throws Error.
  GatheredViews(const Scene& scene, int threads);
  ~GatheredViews();

  /// From here on photographs are shown with their gains times `exposure` (FramePlan::exposure); nullopt, as before the
  /// first call: as they are.
  void expose(const std::optional<glm::dvec3>& exposure);

  reference::Composed compose(const Camera& view);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ibr::app
