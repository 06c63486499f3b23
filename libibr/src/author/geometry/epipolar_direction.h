// SPDX-License-Identifier: Apache-2.0
// Direction in which a match slides along its epipolar line when its point approaches another centre (Hartley and
// Zisserman 2004, chapter 9).
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "ibr/camera.h"

namespace ibr {

/// Unit direction, px of the pinhole `camera`, in which the image of a point at `pixel` moves while the point
/// approaches `centre` (world) along its ray. (0, 0) at the epipole, and if `centre` is the camera's own position: the
/// match then stays fixed, or its direction is undefined.
glm::dvec2 epipolarDirection(const Camera& camera, glm::dvec3 centre, glm::dvec2 pixel);

}  // namespace ibr
