// SPDX-License-Identifier: Apache-2.0
// Decides, from all detected moving objects (movers.h), the mask of each photograph: every surface stays visible in at
// least one photograph, and a moving object is shown consistently.
//
//   1. an unsure region becomes its photograph's own if other photographs' regions attribute enough of it to that
//      photograph
//   2. a photograph's own regions are masked if another photograph shows the background
//   3. a region that hides too much that no other photograph shows is kept whole. The area is then masked in the
//      others, so that all views show that one photograph's state. The regions that hide most are decided first
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "author/movers/movers.h"
#include "author/pixels/bit_mask.h"
#include "ibr/scene.h"

namespace ibr {

/// A photograph and the regions found in it.
struct ComparedView {
  Camera camera;                           // of `found`'s size
  std::vector<std::uint32_t> comparisons;  // views, in the order of DifferingRegion::other
  DifferingRegions found;
};

/// Returns each view's mask; empty if nothing is masked. Takes three bits per pixel of each view.
std::vector<BitMask> resolveMoverMasks(std::span<const ComparedView> views);

}  // namespace ibr
