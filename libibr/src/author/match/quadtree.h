// SPDX-License-Identifier: Apache-2.0
// Where a dense match needs mesh vertices.
//
//   blocks of 32 px; split down to 8 where the match is not one affine map to 0.6 px, or partly missing; down to 4
//   where it is partly missing. A vertex stands at the matched pixel nearest to a block's centre.
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

/// Pixels of the frame, each matched (`good`: 1 channel, not 0), in a fixed order. `positions`: where they are matched,
/// 2 channels each, all of one size.
std::vector<glm::ivec2> meshVertices(const Image8& good, std::span<const ImageF> positions,
                                     const BlockSizes& sizes = {});

}  // namespace ibr
