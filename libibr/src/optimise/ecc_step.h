// SPDX-License-Identifier: Apache-2.0
// The closed form of forward-additive ECC (Evangelidis & Psarakis, PAMI 2008, eqs 15–19) in two unknowns, with priors.
#pragma once

#include <glm/geometric.hpp>
#include <glm/mat2x2.hpp>
#include <optional>

#include "optimise/gradient_sums.h"

namespace ibr {

/// What displacement d, px, from where the point began costs: dᵀ·cost·d, grey² a sample and channel (eccCost).
struct DisplacementPrior {
  glm::dmat2 cost{0.0};
};

/// The step, px, from a point that is `moved` from where it began; along `direction` (unit) alone if there is one.
/// nullopt where there is nothing to go by: no texture, or a step that is not finite.
std::optional<glm::dvec2> eccStep(const GradientSums& sums, const DisplacementPrior& prior, glm::dvec2 moved,
                                  std::optional<glm::dvec2> direction);

}  // namespace ibr
