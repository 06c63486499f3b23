// SPDX-License-Identifier: Apache-2.0
// Changes the edges of a mesh (future work in [T], end of chapter 3): flips an edge if the photographs correlate better
// with the other diagonal, for example where two surfaces meet along it.
#pragma once

#include <cstddef>
#include <span>

#include "ibr/optimiser.h"
#include "optimise/texels.h"

namespace ibr {

struct FlipOptions {
  /// Required rise of the ECC of the two triangles; more with few samples (triangle_agreement.h).
  double gain = 0.005;
  double varianceFloor = 25;  // grey²
  int maxPasses = 8;          // no pass flips an edge next to one that it has flipped
  int threads = 0;            // 0: all cores; does not affect the result
};

/// Flips inner edges of the judged triangles, with both ends fixed or both free; never an edge of a triangle that is
/// only kept. Points do not move. The two new triangles take the indices of the two old ones, so data per triangle keep
/// their place. No new triangle is folded over in an image, in the mean of two or of all (exact), and no flip
/// duplicates an existing edge. Returns the number of flips. Precondition: starMeshOf accepts the alignment; `pictures`
/// are its own.
std::size_t flipEdges(Alignment& alignment, std::span<const Texels> pictures, const FlipOptions& options);

}  // namespace ibr
