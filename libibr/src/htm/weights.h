// SPDX-License-Identifier: Apache-2.0
// View-dependent weights ([H] eq. 5): w = ((V_eye · V_C + 1) / 2)^γ₂, as logarithms.
//
// (1 + cos θ) / 2 = cos²(θ/2) = |a + b|² / (|a + b|² + |a − b|²) is exact to rounding, also for θ near 0 or 180°; no
// cosine can leave [−1, 1]. At 150°, w is e^−135 for γ₂ = 50, and underflows for γ₂ = 1000. Weights therefore stay
// logarithms until the division by the largest one that counts.
#pragma once

#include <span>

#include "ibr/conventions.h"

namespace ibr {

/// Sets the logarithms of eq. 5, one per direction, relative to the largest (which is 0). Always finite: for a
/// direction exactly opposite, cos²(θ/2) is 10⁻³⁰, so that cameras that are all behind the view weigh the same.
/// Directions may have any finite length > 0. Precondition: both spans have the same size.
void htmLogWeights(std::span<const glm::dvec3> directions, glm::dvec3 viewDirection, double gamma,
                   std::span<double> logs);

}  // namespace ibr
