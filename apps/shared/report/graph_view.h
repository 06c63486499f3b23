// SPDX-License-Identifier: Apache-2.0
// Projection that shows an image graph best in a flat drawing.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "ibr/scene.h"

namespace ibr::app {

/// Orthographic projection. right × up = toward, all of unit length, in world axes.
struct GraphView {
  glm::dvec3 centre{0.0};
  glm::dvec3 right{1, 0, 0}, up{0, 1, 0}, toward{0, 0, 1};

  /// Projects a point: world units, y upwards.
  glm::dvec2 flat(glm::dvec3 point) const;
};

/// Looks along the axis of least spread of the photographs' positions, from the side that is up for the cameras. If
/// this axis is horizontal, looks from behind the cameras. The largest spread runs to the right. If two axes have equal
/// spread, the axis nearer to the cameras' up is the view axis. Accepts any scene, an empty one too.
GraphView graphView(const Scene& scene);

}  // namespace ibr::app
