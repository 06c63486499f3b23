// SPDX-License-Identifier: Apache-2.0
// Agreement of the photographs in a few triangles: the criterion for flips and insertions.
#pragma once

#include <optional>
#include <span>

#include "optimise/judge.h"

namespace ibr {

/// Means over the sources, of EccDefinition::channels.
struct TriangleAgreement {
  double ecc = 0;
  double samples = 0;   // of a pair of images
  double variance = 0;  // grey², per sample and channel
};

/// Returns nullopt if a triangle is too large or too steep to be judged.
std::optional<TriangleAgreement> agreementOf(std::span<const Texels> pictures, const Positions& at,
                                             std::span<const glm::uvec3> triangles, double varianceFloor);

/// Rise of the ECC beyond the required gain: `gain` for 1024 samples or more; for n samples, fewer, 32/√n times as
/// much, as correlations scatter. Negative if either could not be judged.
double surplusOf(const std::optional<TriangleAgreement>& before, const std::optional<TriangleAgreement>& after,
                 double gain);

}  // namespace ibr
