// SPDX-License-Identifier: Apache-2.0
// What of each photograph is masked, of all that was found in them to have moved (movers.h): so that each place is
// shown by one photograph at least, and nobody by one photograph and not by the next.
//
//   1. a region whose photograph is unsure is its own where another photograph says so
//   2. what is the photograph's own is masked in it, where another one shows the place without it
//   3. where too much of it hides what nobody else shows it stays, all of it: then that place is masked in the others,
//      so that it is seen from everywhere as that one photograph has it. The most hidden are decided first
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "author/movers/movers.h"
#include "author/pixels/bit_mask.h"
#include "ibr/scene.h"

namespace ibr {

/// A photograph and what was found in it.
struct JudgedView {
  Camera camera;                      // of `odd`'s size
  std::vector<std::uint32_t> judges;  // views, as OddRegion::other counts them
  OddRegions odd;
};

/// Of each view what is masked; empty where nothing is. Takes one bit a pixel of each view, three times.
std::vector<BitMask> settleMovers(std::span<const JudgedView> views);

}  // namespace ibr
