// SPDX-License-Identifier: Apache-2.0
// The vote: turns the hypotheses of a pixel into its surfaces. Pure functions.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "ibr/renderer.h"

namespace ibr::reference {

/// Standard deviation of a surface's colours that halves its weight, 8-bit levels.
inline constexpr double kColourSpread = 15;

/// ρ by which two hypotheses may differ and still be the same surface.
double toleranceOf(double step, double inverseDepth);

/// Relative error of a ρ with the given consensus, one standard deviation.
double uncertaintyOf(double consensus);

/// Weight u of a hypothesis. `distance`: of its photograph, in spacings.
double voteWeight(double photographWeight, double trust, double distance);

struct Vote {
  double inverseDepth = 0;
  double weight = 0;  // u > 0
  double trust = 0, consensus = 0;
};

/// A surface that colours are gathered for.
struct Surface {
  double inverseDepth = 0;  // along the view's axis
  double opacity = 1;       // 0 to 1, relative to the surfaces behind; 1 for the last one
  double uncertainty = 0;   // relative, of ρ
  bool completed = false;   // most of its weight comes from unconfirmed depth
};

/// The surfaces of a pixel, nearest first.
struct Surfaces {
  std::array<Surface, kMaxGatherLayers> surface;
  std::size_t count = 0;  // 0: no hypothesis
  bool filled = false;    // a hole of the vote
  double spread = 0;      // RMS deviation of all hypotheses from the opaque surface, relative to its ρ
  double margin = 1;      // the lesser of two: relative difference of the two largest supports; difference between the
                          // shares of the last surface and of the best one left out. 1 for a single hypothesis
};

/// The nearest surface of at least half opacity. Precondition: there is a surface.
const Surface& opaqueSurface(const Surfaces& surfaces);

/// One standard deviation of the ρ of opaqueSurface(). `variance`: of the colours of the surface with most weight,
/// 8-bit levels².
double deviationOf(const Surfaces& surfaces, bool confirmed, double step, double variance);

/// `votes`: in the order of the candidates; `layers`: maximum number of surfaces, at most kMaxGatherLayers.
Surfaces vote(std::span<const Vote> votes, double step, std::size_t layers);

/// Gives pixels without a hypothesis one surface; ρ is interpolated by pull and push. Pixels are row by row. No effect
/// if no pixel has a surface.
void fillHoles(std::vector<Surfaces>& pixels, int width, int height);

}  // namespace ibr::reference
