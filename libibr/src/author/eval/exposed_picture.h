// SPDX-License-Identifier: Apache-2.0
// A photograph at another exposure, on the CPU.
#pragma once

#include <glm/vec3.hpp>

#include "ibr/image.h"

namespace ibr {

/// The picture as a renderer shows it with this gain: R, G, B of linear light, > 0 (shared/cell.h). Further channels
/// are kept. Precondition: 3 channels or more.
Image8 exposedPicture(Image8 picture, glm::dvec3 gain);

}  // namespace ibr
