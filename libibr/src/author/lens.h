// SPDX-License-Identifier: Apache-2.0
// Distortion of the plane, with its derivative.
#pragma once

#include <glm/mat2x2.hpp>

#include "ibr/lens.h"

namespace ibr {

struct Distorted {
  glm::dvec2 point;      // d(m)
  glm::dmat2 jacobian;   // ∂d/∂m, column by column
};
Distorted distort(const LensDistortion& distortion, glm::dvec2 m);

/// The radial part alone: r·N(r²)/D(r²), or that of FOV, and its derivative.
struct RadialValue {
  double value, slope;
};
RadialValue radial(const LensDistortion& distortion, double r);

}  // namespace ibr
