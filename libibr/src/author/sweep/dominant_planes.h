// SPDX-License-Identifier: Apache-2.0
// Finds planes that much of the scene lies on, as the ground or a long wall, from points that photographs share.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "ibr/camera.h"

namespace ibr {

/// Largest first; empty if no plane holds many of the points. A plane is given by its inverse depth along the frame's
/// axis, linear in the frame's image: n·(x, y, 1), px. The result does not depend on the scene's position in the world.
std::vector<glm::dvec3> dominantPlanes(const Camera& frame, std::span<const Camera> members,
                                       std::span<const glm::dvec3> points);

}  // namespace ibr
