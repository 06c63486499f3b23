// SPDX-License-Identifier: Apache-2.0
// What moved while a place was photographed: people, cars. A photograph that shows them is the odd one.
//
//   1. the photograph's depth, as its sweep found it (photograph_sweep.h), where another photograph looks alike at it;
//      completed from around elsewhere (complete_depth.h): the depth of the background, not of the person before it
//   2. the others are brought to the photograph through it. Where its colours lie outside the range of another one's
//      around the pixel, or that one's outside the range of its own, after a gain a channel, the two differ: a pixel or
//      two off makes no difference
//   3. regions that differ from all others that see them, amid what agrees. A thin or a small one is left out, and one
//   of
//      which a share looks like another photograph at any depth: it stands still, and its depth was wrong
//   4. whose is it? The wall that somebody hides is to be found beside him, he is not: what is less familiar
//      (familiar.h) moved. One region may be the photograph's own in one part and another one's in the next
//
// Who is blamed in the end, and what is masked, is settled between all photographs (settle_movers.h).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "author/match/match.h"
#include "ibr/image.h"

namespace ibr {

enum class Blame : std::uint8_t { own, unsure, another };

/// A pixel of the view at half its size, and the inverse depth along the view's axis of what stands still there.
struct OddPixel {
  std::uint16_t x = 0, y = 0;
  float inverseDepth = 0;
};

struct OddRegion {
  Blame blame = Blame::unsure;
  std::uint32_t other = 0;  // Blame::another: whose it is, of `others`
  std::vector<OddPixel> pixels;
};

/// Regions of a view at half its size; those of one blame do not overlap. They cover at most a quarter of it.
struct OddRegions {
  int width = 0, height = 0;
  std::vector<OddRegion> regions;
  ImageF depth;  // inverse, of every kDepthStep-th pixel: what stands still
};

inline constexpr int kDepthStep = 4;

/// `others`: of the same place, pinholes like `view`, one at least. `depth`: inverse, along the view's axis, of a
/// picture of any size; kUnknownDepth where it was not found.
OddRegions oddRegions(const MatchView& view, std::span<const MatchView> others, const ImageF& depth);

}  // namespace ibr
