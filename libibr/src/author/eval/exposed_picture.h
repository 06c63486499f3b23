// SPDX-License-Identifier: Apache-2.0
// Changes a photograph's exposure, on the CPU.
#pragma once

#include <glm/vec3.hpp>

#include "ibr/image.h"

namespace ibr {

/// The image as a renderer shows it with this gain: R, G, B factors of linear light, > 0 (shared/cell.h). Further
/// channels are unchanged. Precondition: 3 channels or more.
Image8 applyGain(Image8 picture, glm::dvec3 gain);

}  // namespace ibr
