// SPDX-License-Identifier: Apache-2.0
// From where an image graph is best looked at in a flat picture.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "ibr/scene.h"

namespace ibr::app {

/// An orthographic view. right × up = toward, all of unit length, in world axes.
struct GraphView {
  glm::dvec3 centre{0.0};
  glm::dvec3 right{1, 0, 0}, up{0, 1, 0}, toward{0, 0, 1};

  /// World units, y upwards.
  glm::dvec2 flat(glm::dvec3 point) const;
};

/// Along the axis of least spread of the photographs' places, from the side that is up for the cameras (from behind
/// them where that axis lies level); the greatest spread runs to the right. Where two axes spread alike, the one of
/// them that is nearer to the cameras' up. Of any scene, an empty one too.
GraphView graphView(const Scene& scene);

}  // namespace ibr::app
