// SPDX-License-Identifier: Apache-2.0
// Cube of pinhole images on which panoramas are matched ([T] §4.2); results are mapped back to the sphere.
#pragma once

#include <array>
#include <numbers>

#include "ibr/author/panorama.h"

namespace ibr {

/// Field of view of the faces on which panoramas are matched and optimised, radians.
inline constexpr double kMatchedFaceFov = 110.0 * std::numbers::pi / 180.0;

/// Rotations from face axes to the cube's axes, of six faces that look along ±x, ±y and ±z: those of cubeFaces().
std::array<glm::dquat, 6> cubeRotations();

/// Solid angle of a triangle of unit directions (van Oosterom & Strackee 1983).
double solidAngle(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c);

}  // namespace ibr
