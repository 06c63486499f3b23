// SPDX-License-Identifier: Apache-2.0
// What is known of the depth in a photograph: from the meshes of a scene's cells, or from points.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "ibr/image.h"
#include "ibr/scene.h"

namespace ibr {

/// Inverse depth along the photograph's axis in its picture scaled to `size`: of each cell the nearest surface of tier
/// 0, of all cells the median (the farther of two); kUnknownDepth where no cell has one. Precondition: a pinhole.
ImageF depthInScene(const Scene& scene, std::uint32_t node, glm::ivec2 size);

/// The same in the picture of a pinhole that stands at the photograph's place and may look any way, as a face of a
/// panorama does. Triangles that reach behind it are left out.
ImageF depthInScene(const Scene& scene, std::uint32_t node, const Camera& face);

/// The same from points of the world that `camera` sees, in its picture's own size: of those in a pixel the median (the
/// farther of two).
ImageF depthOfPoints(const Camera& camera, std::span<const glm::dvec3> points);

/// Pixel by pixel, the median (the farther of two) of the maps that know one. Does not depend on their order.
/// Precondition: one map at least, all of one size.
ImageF medianDepth(std::span<const ImageF> maps);

}  // namespace ibr
