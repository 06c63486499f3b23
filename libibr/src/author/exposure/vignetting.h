// SPDX-License-Identifier: Apache-2.0
// What lenses take from a picture's corners, and giving it back.
//
// A lens lets the share exp(k.x·r² + k.y·r⁴) of the light through, r from the principal point in half diagonals of the
// picture (even powers: the shade is smooth in its middle). Coefficients come from matches
// (author/exposure/exposure.h); where a build is asked to, pictures and textures are stored without the shade, as they
// are stored without distortion.
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

/// In half diagonals. 0 all over a panorama: it was stitched, and has no lens of its own.
double vignettingRadius(const Intrinsics& intrinsics, glm::dvec2 pixel);

/// Of each photograph the number of its lens, from 0: photographs share one if EXIF says the same of camera, lens,
/// aperture and focal length, and their files have one size and, to a tenth, one focal length in pixels.
std::vector<std::uint32_t> lensesOf(const std::vector<Photograph>& photographs);

/// Whether it changes no pixel of the picture by more than 1 %.
bool isNegligible(glm::dvec2 vignetting);

/// Linear light divided by the lens's share, but by no less than an eighth; what is clipped stays white.
Image8 unvignetted(const Image8& picture, const Intrinsics& intrinsics, glm::dvec2 vignetting);

/// For people: how dark corners were, a clause for each lens.
std::string describedVignetting(const std::vector<glm::dvec2>& vignetting, const std::vector<std::uint32_t>& lenses);

}  // namespace ibr
