// SPDX-License-Identifier: Apache-2.0
// Inserts points where a mesh is too coarse for its content (future work in [T], end of chapter 3). A triangle in
// which the photographs correlate badly in spite of texture is split, if its new point finds a position of better
// agreement.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "ibr/optimiser.h"
#include "optimise/star_mesh.h"
#include "optimise/texels.h"

namespace ibr {

struct InsertRequest {
  std::size_t most = 0;    // points
  int radius = 0;          // search radius of a new point, 1/128 px
  std::uint32_t seed = 0;  // of the trials
};

/// Adds points to judged triangles whose ECC is below options.insertBelow: in the middle of the longest edge with
/// judged triangles on both sides. Otherwise (border, triangles that are only kept) in the middle of the
/// triangle. Then only the new points move, in two cycles of the options' method (on the CPU). A point stays if
/// the ECC of the triangles around it rises by options.insertGain, more with few samples (triangle_agreement.h);
/// the best first. No triangle folds over (exact), and each edge keeps the triangles on its sides, or is halved
/// with both.
///
/// The first parts of a split have the indices of the split triangles, the others come last. A new point has the last
/// index and an entry in alignment.inserted. `began` (d × n) gets each new point's position before its search. Returns
/// the number of points, independent of the number of threads. Precondition: starMeshOf accepts the alignment;
/// `pictures` are its own.
std::size_t insertPoints(
    Alignment& alignment, Positions& began, const std::vector<Texels>& pictures, const AlignmentOptions& options,
    const InsertRequest& request, const std::function<void()>& keepGoing = [] {});

}  // namespace ibr
