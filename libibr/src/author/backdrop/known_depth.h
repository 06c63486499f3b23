// SPDX-License-Identifier: Apache-2.0
// Depth of a photograph from points of the world.
#pragma once

#include <glm/vec3.hpp>
#include <span>

#include "ibr/camera.h"
#include "ibr/image.h"

namespace ibr {

/// Inverse depth along the camera's axis in its picture's own size: of the points in a pixel the median (the farther of
/// two), kUnknownDepth where there is none.
ImageF depthOfPoints(const Camera& camera, std::span<const glm::dvec3> points);

}  // namespace ibr
