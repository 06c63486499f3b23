// SPDX-License-Identifier: Apache-2.0
// Sums over the samples of a star for a move of its point in one image, as input of the closed form of
// forward-additive ECC (Evangelidis & Psarakis, PAMI 2008, eqs 15–19).
//
// A pixel of the mean stays fixed while the point moves by δ. Let φ be the point's weight at the pixel and J the map
// from the mean to the source. The source is read (I − J/2)φδ further, the target as much behind. Together this equals
// a change of the source alone by g·δ, g = φ(I − J/2)ᵀ(∇source + ∇target).
//
// Departure: in the paper the template is fixed and only the source has a gradient.
#pragma once

#include <glm/vec2.hpp>

#include "ibr/ecc.h"
#include "optimise/judge.h"

namespace ibr {

/// Centred sums over samples and channels, in grey levels and px: of the source x, the target y and g.
struct GradientSums {
  double samples = 0;  // samples times channels
  double xx = 0, xy = 0, yy = 0;
  glm::dvec2 xg{0}, yg{0};
  double g00 = 0, g01 = 0, g11 = 0;
};

/// Sums over the point's star, displaced by `offset` in `member`, in `rows` of the mean. The floor (grey²) is a
/// constant common signal, as in EccDefinition::channels. Returns 0 samples if a triangle cannot be judged.
GradientSums gradientSums(const JudgeInput& input, const Positions& at, std::uint32_t point, std::size_t member,
                          glm::ivec2 offset, EccDefinition definition, double varianceFloor, RowChoice rows = {});

}  // namespace ibr
