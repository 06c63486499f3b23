// SPDX-License-Identifier: Apache-2.0
// What the meshes of a finished scene say of the depth in one of its photographs.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>

#include "ibr/image.h"
#include "ibr/scene.h"

namespace ibr {

/// Inverse depth along the photograph's axis in its picture scaled to `size`: of each cell the nearest surface of tier
/// 0, of all cells the median (the farther of two); kUnknownDepth where no cell has one. Precondition: a pinhole.
ImageF depthInScene(const Scene& scene, std::uint32_t node, glm::ivec2 size);

}  // namespace ibr
