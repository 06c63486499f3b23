// SPDX-License-Identifier: Apache-2.0
// How well the photographs agree in a few triangles: what decides whether points are joined in another way.
#pragma once

#include <optional>
#include <span>

#include "optimise/judge.h"

namespace ibr {

/// Means over the sources, of the definition `channels`.
struct TriangleAgreement {
  double ecc = 0;
  double samples = 0;   // of a pair of pictures
  double variance = 0;  // grey², a sample and channel
};

/// nullopt where a triangle is too large or too steep to be judged.
std::optional<TriangleAgreement> agreementOf(std::span<const Texels> pictures, const Positions& at,
                                             std::span<const glm::uvec3> triangles, double varianceFloor);

/// By how much ECC has risen beyond what is asked for: `gain` where there are 1024 samples or more, with fewer, n,
/// 32/√n times as much, as the scatter of a correlation is. Below 0 where either could not be judged.
double surplusOf(const std::optional<TriangleAgreement>& before, const std::optional<TriangleAgreement>& after,
                 double gain);

}  // namespace ibr
