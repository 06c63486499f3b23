// SPDX-License-Identifier: Apache-2.0
// Where a match slides in a picture when its point goes nearer or further as seen from somewhere else (Hartley and
// Zisserman 2004, chapter 9).
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "ibr/camera.h"

namespace ibr {

/// Unit direction in px of the pinhole `camera` in which the image of a point at `pixel` moves while the point moves
/// along its ray from `centre`, a place in the world, as it comes nearer. (0, 0) at the epipole itself, and where
/// `centre` is the camera's own: the match then stays where it is, or may be anywhere.
glm::dvec2 epipolarDirection(const Camera& camera, glm::dvec3 centre, glm::dvec2 pixel);

}  // namespace ibr
