// SPDX-License-Identifier: Apache-2.0
// Chooses mesh vertices for a dense match, by quadtree.
//
//   Blocks of 32 px are split down to 8 px if the match is not affine within 0.6 px or partly missing; down to 4 px if
//   partly missing. A block's vertex is the matched pixel nearest to its centre.
#pragma once

#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "ibr/image.h"

namespace ibr {

struct BlockSizes {
  int largest = 32, smallest = 8, atEdges = 4;  // px, powers of two
  double affine = 0.6;                          // px
};

/// Returns matched pixels of the frame in a fixed order. `good`: 1 channel, not 0 where matched. `positions`: matched
/// positions in each member, 2 channels each, all of one size.
std::vector<glm::ivec2> meshVertices(const Image8& good, std::span<const ImageF> positions,
                                     const BlockSizes& sizes = {});

}  // namespace ibr
