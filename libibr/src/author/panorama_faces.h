// SPDX-License-Identifier: Apache-2.0
// Pinhole pictures of a panorama ([T] §4.2): what is found in them is carried back to the sphere.
#pragma once

#include <array>

#include "ibr/camera.h"
#include "ibr/image.h"

namespace ibr {

/// Rotations, from face axes to the cube's, of six faces that look along ±x, ±y and ±z.
std::array<glm::dquat, 6> cubeRotations();

/// A square picture, `size` px wide, of the directions within `fovRadians` (0 < fov < π).
Intrinsics faceIntrinsics(int size, double fovRadians);

/// The size at which such a face has as many pixels an angle, in its middle, as a panorama `width` px wide has at its
/// equator; at least 1.
int faceSize(int panoramaWidth, double fovRadians);

/// The panorama (8 bits, any channels) as a pinhole at its centre sees it. `rotation`: from the pinhole's axes to the
/// panorama's. Bilinear, across the seam and over the poles.
Image8 facePicture(const Image8& panorama, const Intrinsics& face, glm::dquat rotation);

}  // namespace ibr
