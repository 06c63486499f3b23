// SPDX-License-Identifier: Apache-2.0
// Reference implementation, in double precision, of photograph filters: trilinear, bicubic (Keys 1981), and along a
// panorama's parallels (shared/panorama.h). Levels are RGBA; positions are 0 to 1, (0, 0) is the image's corner. Pure.
#pragma once

#include <algorithm>
#include <glm/common.hpp>
#include <vector>

#include "ibr/camera.h"
#include "ibr/image.h"

namespace ibr::reference {

struct Texel {
  glm::dvec3 colour{0};  // 0 to 1
  double range = 0;      // as RenderedImage::range and RenderedImage::levelRange (cell_pass_reference.h)
  double levelRange = 0;
  double alpha = 0;  // 0 to 1
};

inline double largest(glm::dvec3 v) {
  return std::max({v.x, v.y, v.z});
}

/// Weighted sum; its ranges are the larger ones of both texels.
inline Texel mixed(const Texel& a, double weightA, const Texel& b, double weightB) {
  return {weightA * a.colour + weightB * b.colour, std::max(a.range, b.range), std::max(a.levelRange, b.levelRange),
          weightA * a.alpha + weightB * b.alpha};
}

/// Multiplies the linear light of a display-encoded colour by a gain (shared/cell.h, exposedColour). The result is not
/// clamped.
glm::dvec3 exposedColour(glm::dvec3 colour, glm::dvec3 gain);

/// `footprint`: texels of the finest level between neighbouring pixels; `around`: x wraps, for panoramas.
Texel trilinear(const std::vector<Image8>& levels, glm::dvec2 at, double footprint, bool around, bool cubic);

/// `here`: q_i at the pixel; `dx`, `dy`: differences of its unit ray to the neighbouring pixels.
Texel samplePanorama(const std::vector<Image8>& levels, const Intrinsics& k, glm::dvec3 here, glm::dvec3 dx,
                     glm::dvec3 dy, bool cubic);

}  // namespace ibr::reference
