// SPDX-License-Identifier: Apache-2.0
// Lens distortion of the image plane, with its derivative, and the parameters of a lens.
#pragma once

#include <glm/mat2x2.hpp>
#include <vector>

#include "ibr/author/lens.h"

namespace ibr {

struct Distorted {
  glm::dvec2 point;     // d(m)
  glm::dmat2 jacobian;  // ∂d/∂m, column-major
};
Distorted distort(const LensDistortion& distortion, glm::dvec2 m);

/// Parameters that the lens was constructed from, in the order of its model.
std::vector<double> parametersOf(const Lens& lens);

/// The radial part alone and its derivative: r·N(r²)/D(r²), or the FOV model's.
struct RadialValue {
  double value, slope;
};
RadialValue radial(const LensDistortion& distortion, double r);

}  // namespace ibr
