// SPDX-License-Identifier: Apache-2.0
// How the samples of a star change as its point moves in one picture, summed up for the closed form of forward-additive
// ECC (Evangelidis & Psarakis, PAMI 2008, eqs 15–19).
//
// A pixel of the mean is held where it is while the point moves by δ. With φ the point's weight there and J the map
// from the mean to the source, the source is read (I − J/2)φδ further and the target as much behind: together as if the
// source alone changed by g·δ, g = φ(I − J/2)ᵀ(∇source + ∇target).
//
// Departure: in the paper the template is fixed and only the source has a gradient.
#pragma once

#include <glm/vec2.hpp>

#include "ibr/ecc.h"
#include "optimise/judge.h"

namespace ibr {

/// Centred sums over samples and channels, in grey levels and px: of the source x, the target y and g.
struct GradientSums {
  double samples = 0;  // and channels
  double xx = 0, xy = 0, yy = 0;
  glm::dvec2 xg{0}, yg{0};
  double g00 = 0, g01 = 0, g11 = 0;
};

/// Of the point's star at its place plus `offset` in `member`, in `rows` of the mean. The floor (grey²) is a common
/// signal that does not change, as in the definition `channels`. Nothing (0 samples) where a triangle cannot be judged.
GradientSums gradientSums(const JudgeInput& input, const Positions& at, std::uint32_t point, std::size_t member,
                          glm::ivec2 offset, EccDefinition definition, double varianceFloor, RowChoice rows = {});

}  // namespace ibr
