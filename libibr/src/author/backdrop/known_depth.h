// SPDX-License-Identifier: Apache-2.0
// What is known of the depth in a photograph: from points of the world, or from several maps.
#pragma once

#include <glm/vec3.hpp>
#include <span>

#include "ibr/camera.h"
#include "ibr/image.h"

namespace ibr {

/// Inverse depth along the camera's axis in its picture's own size: of the points in a pixel the median (the farther of
/// two), kUnknownDepth where there is none.
ImageF depthOfPoints(const Camera& camera, std::span<const glm::dvec3> points);

/// Pixel by pixel, the median (the farther of two) of the maps that know one. Does not depend on their order.
/// Precondition: one map at least, all of one size.
ImageF medianDepth(std::span<const ImageF> maps);

}  // namespace ibr
