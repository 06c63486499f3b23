// SPDX-License-Identifier: Apache-2.0
// The vote: the hypotheses of a pixel become its surfaces. Pure.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "ibr/renderer.h"

namespace ibr::reference {

/// Standard deviation of a surface's colours, 8-bit levels, that halves its weight.
inline constexpr double kColourSpread = 15;

/// ρ by which two hypotheses may differ and still be the same surface.
double toleranceOf(double step, double inverseDepth);

/// Share of itself by which a ρ of that consensus may be off, one standard deviation.
double uncertaintyOf(double consensus);

/// Weight u of a hypothesis. `distance`: of its photograph, spacings.
double voteWeight(double photographWeight, double trust, double distance);

struct Vote {
  double inverseDepth = 0;
  double weight = 0;  // u > 0
  double trust = 0, consensus = 0;
};

/// A surface that colours are gathered for.
struct Surface {
  double inverseDepth = 0;  // along the view's axis
  double opacity = 1;       // 0 to 1, of what lies behind; of the last surface 1
  double uncertainty = 0;   // of ρ, a share of it
  bool completed = false;   // most of its weight comes from depth that nobody confirmed
};

/// The surfaces of a pixel, nearest first.
struct Surfaces {
  std::array<Surface, kMaxGatherLayers> surface;
  std::size_t count = 0;  // 0: nothing is known
  bool filled = false;    // a hole of the vote
  double spread = 0;      // of all hypotheses about the opaque surface: root of their mean square, a share of its ρ
  double margin = 1;      // the lesser of two differences: of the two largest supports, in the largest; of what the
                          // last surface and the one after it show of the pixel. 1 where there are no two
};

/// The nearest surface that hides at least half of what lies behind. Precondition: there is a surface.
const Surface& opaqueSurface(const Surfaces& surfaces);

/// One standard deviation of its ρ. `variance`: of the colours of the surface that counts most, 8-bit levels².
double deviationOf(const Surfaces& surfaces, bool confirmed, double step, double variance);

/// `votes`: in the order of the candidates; `layers`: most surfaces, at most kMaxGatherLayers.
Surfaces vote(std::span<const Vote> votes, double step, std::size_t layers);

/// Gives pixels without a hypothesis one surface, whose ρ is interpolated from around by pull and push. Row by row.
/// Nothing happens where no pixel has a surface.
void fillHoles(std::vector<Surfaces>& pixels, int width, int height);

}  // namespace ibr::reference
