// SPDX-License-Identifier: Apache-2.0
// The cube of pinhole pictures that panoramas are matched on ([T] §4.2): what is found in them is carried back to the
// sphere.
#pragma once

#include <array>

#include "ibr/panorama.h"

namespace ibr {

/// Rotations, from face axes to the cube's, of six faces that look along ±x, ±y and ±z: those of cubeFaces().
std::array<glm::dquat, 6> cubeRotations();

}  // namespace ibr
