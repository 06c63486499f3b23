// SPDX-License-Identifier: Apache-2.0
// The closed form of forward-additive ECC (Evangelidis & Psarakis, PAMI 2008, eqs 15–19) in two unknowns, with priors.
#pragma once

#include <glm/geometric.hpp>
#include <glm/mat2x2.hpp>
#include <optional>

#include "optimise/gradient_sums.h"

namespace ibr {

/// Cost of a displacement d, px, from the point's start: dᵀ·cost·d, grey² per sample and channel (eccCost).
struct DisplacementPrior {
  glm::dmat2 cost{0.0};
};

/// Step, px, of a point displaced by `moved` from its start; along `direction` (unit) only, if given. Returns nullopt
/// without texture, or if the step is not finite.
std::optional<glm::dvec2> eccStep(const GradientSums& sums, const DisplacementPrior& prior, glm::dvec2 moved,
                                  std::optional<glm::dvec2> direction);

}  // namespace ibr
