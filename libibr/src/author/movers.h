// SPDX-License-Identifier: Apache-2.0
// What moved while a place was photographed: people, cars. A photograph that shows them is the odd one.
//
//   1. depth in the photograph's frame: swept with each other photograph, kept where the two look alike, completed from
//      around elsewhere (complete_depth.h): the depth of what is behind, not of who stands before it
//   2. the others are brought to the photograph through it. Where its colours lie outside the range of another one's
//      around the pixel, or that one's outside the range of its own, after a gain a channel, the two differ: a pixel or
//      two off makes no difference
//   3. regions that differ from all others that see them, by hysteresis; none that is thin, small, or for the most part
//      looks like another photograph at some other depth: that stands still
//   4. whose is it? Who shows a mover shows its outline; in another photograph colours go on across it. A region counts
//      where its outline is much stronger in the photograph than in one of the others
#pragma once

#include <glm/vec3.hpp>
#include <span>

#include "author/match.h"

namespace ibr {

/// A mask of half the view's size: 0 where something moved. `others`: of the same place, pinholes like `view`, one at
/// least. `points` give the sweep its range. Throws Error{invalidInput} where none of them lies before the view.
Image8 moverMask(const MatchView& view, std::span<const MatchView> others, std::span<const glm::dvec3> points);

}  // namespace ibr
