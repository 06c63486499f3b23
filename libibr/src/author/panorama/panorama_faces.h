// SPDX-License-Identifier: Apache-2.0
// The cube of pinhole pictures that panoramas are matched on ([T] §4.2): what is found in them is carried back to the
// sphere.
#pragma once

#include <array>
#include <numbers>

#include "ibr/panorama.h"

namespace ibr {

/// Field of view of the faces on which panoramas are matched and optimised, radians.
inline constexpr double kMatchedFaceFov = 110.0 * std::numbers::pi / 180.0;

/// Rotations, from face axes to the cube's, of six faces that look along ±x, ±y and ±z: those of cubeFaces().
std::array<glm::dquat, 6> cubeRotations();

/// Solid angle of a triangle of unit directions (van Oosterom & Strackee 1983).
double solidAngle(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c);

}  // namespace ibr
