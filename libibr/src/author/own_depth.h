// SPDX-License-Identifier: Apache-2.0
// What the matches of cells say of the depth in a member's own photograph.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "author/match.h"
#include "ibr/image.h"

namespace ibr {

/// Inverse depth along the member's axis in its picture, brought to `size`: the median (the farther of two) of
/// what falls into a pixel of it, kUnknownDepth where no other member shows its texture.
ImageF ownDepth(const DenseMatch& match, const Camera& member, std::size_t index, glm::ivec2 size);

/// The same from points of the world that `camera` sees, in its picture's own size.
ImageF depthOfPoints(const Camera& camera, std::span<const glm::dvec3> points);

/// Pixel by pixel, the median (the farther of two) of the maps that know one. Does not depend on their order.
/// Precondition: one map at least, all of one size.
ImageF medianDepth(std::span<const ImageF> maps);

/// Makes regions of few pixels unknown that nothing around them bears out. `parallaxPx`: of inverse depth 1.
void dropIslands(ImageF& inverseDepth, double parallaxPx);

}  // namespace ibr
