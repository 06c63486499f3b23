// SPDX-License-Identifier: Apache-2.0
// More points where a mesh is too coarse for what it shows (future work in [T], end of chapter 3): a triangle in which
// the photographs agree badly, though they have texture there, is split, if its new point finds a place where they
// agree better.
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
  int radius = 0;          // within which a new point looks for its place, 1/128 px
  std::uint32_t seed = 0;  // of the trials
};

/// Adds points to judged triangles whose ECC is below options.insertBelow: in the middle of the longest edge that has a
/// judged triangle on either side, else (border, triangles that are only kept) in the middle of the triangle. The new
/// points alone then try places, as points do in two cycles of the options' method (on the processor); those stay that
/// make the ECC of the triangles around them rise by options.insertGain, more where these have few samples
/// (triangle_agreement.h), the best first. No triangle is folded over (exact), and each edge has the same triangles on
/// its sides, or is halved with both.
///
/// A point's first triangles have the indices of those that it splits, the others come last; a point is the last one,
/// and is described in alignment.inserted. `began` (d × n) gets where each new point stood before it looked for its
/// place. Gives the number of points. Does not depend on the number of threads. Precondition: starMeshOf takes the
/// alignment; `pictures` are its own.
std::size_t insertPoints(
    Alignment& alignment, Positions& began, const std::vector<Texels>& pictures, const AlignmentOptions& options,
    const InsertRequest& request, const std::function<void()>& keepGoing = [] {});

}  // namespace ibr
