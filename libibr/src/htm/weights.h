// SPDX-License-Identifier: Apache-2.0
// View-dependent weights ([H] eq. 5): w = ((V_eye · V_C + 1) / 2)^γ₂, as logarithms.
//
// (1 + cos θ) / 2 = cos²(θ/2) = |a + b|² / (|a + b|² + |a − b|²): exact to rounding also where θ is near 0 or 180°,
// with no cosine that could leave [−1, 1]. At γ₂ = 50 and 150° w is e^−135, at γ₂ = 1000 it is no number at all: so it
// stays a logarithm until it is divided by the largest one that counts.
#pragma once

#include <span>
#include <vector>

#include "ibr/conventions.h"

namespace ibr {

/// Logarithms of eq. 5 for one direction each, relative to the largest (which is 0). Always finite: what looks exactly
/// the other way counts as cos²(θ/2) = 10⁻³⁰, so that cameras that are all behind weigh the same. Directions of any
/// finite length > 0.
std::vector<double> htmLogWeights(std::span<const glm::dvec3> directions, glm::dvec3 viewDirection, double gamma);

}  // namespace ibr
