// SPDX-License-Identifier: Apache-2.0
// Vignetting: the darkening of an image's corners by the lens, and its correction.
//
// A lens transmits the share exp(k.x·r² + k.y·r⁴) of the light, where r is the distance from the principal point in
// half diagonals. Powers are even because the shade is smooth in its middle. Coefficients come from matches
// (author/exposure/exposure.h). On request a build stores images and textures without vignetting, as without
// distortion.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <string>
#include <vector>

#include "author/photographs/photographs.h"
#include "ibr/camera.h"
#include "ibr/image.h"

namespace ibr {

inline double logVignetting(glm::dvec2 k, double radius) {
  const double square = radius * radius;
  return square * (k.x + square * k.y);
}

/// Distance from the principal point in half diagonals; 0 everywhere on a panorama, which is stitched.
double vignettingRadius(const Intrinsics& intrinsics, glm::dvec2 pixel);

/// Lens index of each photograph, from 0. Photographs share a lens if EXIF agrees on camera, lens, aperture and focal
/// length, and their files have the same size and, within a tenth, the same focal length in px.
std::vector<std::uint32_t> lensIndices(const std::vector<Photograph>& photographs);

/// True if the vignetting changes no pixel by more than 1 % of linear light.
bool isNegligible(glm::dvec2 vignetting);

/// Divides linear light by the lens's share, at least 1/8; clipped pixels stay white.
Image8 unvignetted(const Image8& picture, const Intrinsics& intrinsics, glm::dvec2 vignetting);

/// Describes how dark the corners were, one clause per lens, for people.
std::string describeVignetting(const std::vector<glm::dvec2>& vignetting, const std::vector<std::uint32_t>& lenses);

}  // namespace ibr
