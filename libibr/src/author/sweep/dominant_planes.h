// SPDX-License-Identifier: Apache-2.0
// Planes that much of the scene lies on, as the ground or a long wall, from the points that photographs share.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "ibr/camera.h"

namespace ibr {

/// The largest first; none where no plane holds many of the points. Each is given by its inverse depth along the
/// frame's axis, linear in the frame's picture: n·(x, y, 1), px. The same scene gives the same planes wherever in the
/// world it stands.
std::vector<glm::dvec3> dominantPlanes(const Camera& frame, std::span<const Camera> members,
                                       std::span<const glm::dvec3> points);

}  // namespace ibr
