// SPDX-License-Identifier: Apache-2.0
// Where a dense match needs mesh vertices.
//
//   blocks of 32 px; split down to 8 where the match is not one affine map to 0.6 px, or partly missing; down to 4
//   where it is partly missing. A vertex stands at the matched pixel nearest to a block's centre.
#pragma once

#include <glm/vec2.hpp>
#include <vector>

#include "author/match.h"

namespace ibr {

/// Pixels of the frame, each matched in all members, in a fixed order.
std::vector<glm::ivec2> meshVertices(const DenseMatch& match);

}  // namespace ibr
