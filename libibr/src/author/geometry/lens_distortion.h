// SPDX-License-Identifier: Apache-2.0
// Distortion of the plane, with its derivative; a lens's parameters.
#pragma once

#include <glm/mat2x2.hpp>
#include <vector>

#include "ibr/lens.h"

namespace ibr {

struct Distorted {
  glm::dvec2 point;     // d(m)
  glm::dmat2 jacobian;  // ∂d/∂m, column by column
};
Distorted distort(const LensDistortion& distortion, glm::dvec2 m);

/// What the lens was made from: its model's parameters, in their order.
std::vector<double> parametersOf(const Lens& lens);

/// The radial part alone: r·N(r²)/D(r²), or that of FOV, and its derivative.
struct RadialValue {
  double value, slope;
};
RadialValue radial(const LensDistortion& distortion, double r);

}  // namespace ibr
