// SPDX-License-Identifier: Apache-2.0
// Depth map of a photograph from world points.
#pragma once

#include <glm/vec3.hpp>
#include <span>

#include "ibr/camera.h"
#include "ibr/image.h"

namespace ibr {

/// Inverse depth along the camera's axis, at the size of its image. A pixel gets the median of its points (of an even
/// number the farther one of the middle two), kUnknownDepth without points.
ImageF depthOfPoints(const Camera& camera, std::span<const glm::dvec3> points);

}  // namespace ibr
