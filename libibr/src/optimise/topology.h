// SPDX-License-Identifier: Apache-2.0
// Which points a mesh joins (future work in [T], end of chapter 3): an edge is flipped where the photographs agree
// better with the other diagonal, as where two surfaces meet along it.
#pragma once

#include <cstddef>
#include <span>

#include "ibr/optimiser.h"
#include "optimise/texels.h"

namespace ibr {

struct FlipOptions {
  /// What the ECC of the two triangles must rise by; more where they have few samples (triangle_agreement.h).
  double gain = 0.005;
  double varianceFloor = 25;  // grey²
  int mostPasses = 8;         // of which none flips beside an edge that it has flipped
  int threads = 0;            // 0 = all cores; the result does not depend on it
};

/// Flips inner edges of the judged triangles: with both ends fixed or both free, none of a triangle that is only kept.
/// Points stay. The two new triangles have the indices of the two old ones, so the list keeps its length and what else
/// is known of its triangles stays beside them; none is folded over in a picture, in the mean of two or of all (exact),
/// and no two triangles come to share an edge that was there already. Gives the number of flips. Precondition:
/// starMeshOf takes the alignment; `pictures` are its own.
std::size_t flipEdges(Alignment& alignment, std::span<const Texels> pictures, const FlipOptions& options);

}  // namespace ibr
