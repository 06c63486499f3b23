// SPDX-License-Identifier: Apache-2.0
// Changes in the order of cells, or of backdrops, that nobody sees as a jump. A mesh is either.
//
// A mesh that changes its place is there twice for a while: the copy further back stays as it is, the one in front
// fades, out where the mesh fell back, in where it came forward. A mesh that had been left out fades in; one that is no
// longer drawn waits where it was for what arrives, then fades out. What comes into view is there at once: it enters at
// the border of the picture.
//
//   the longest common subsequence of the orders shown and wanted stays; all others leave, and enter anew
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "ibr/renderer.h"

namespace ibr {

struct WantedOrder {
  std::span<const std::uint32_t> meshes;                 // cells, or backdrops: best first, each once
  std::function<bool(std::uint32_t mesh)> wasHidden;     // visible in the frame before, and not drawn
  std::function<bool(std::uint32_t mesh)> stillVisible;  // of a mesh that is no longer wanted
  std::size_t mostLeaving = kLargestLeavingCount;
};

/// What this frame shows: the wanted meshes in their order, and between them those that leave, at most
/// `mostLeaving`. `step` is the share of a fade that this frame goes; 1 or more cuts, and so does a `before` that
/// is empty or leaves nothing in view.
std::vector<ShownMesh> showMeshes(std::span<const ShownMesh> before, const WantedOrder& wanted, double step);

/// The order wanted, but not before the last change of the one shown has faded: until then what is shown and visible
/// keeps its place, and what comes into view, unlike what was hidden, stands behind it; `most` in all. Where that is
/// less than half of what is wanted, it is the order wanted at once: too much would be missing.
std::vector<std::uint32_t> keepWhileFading(std::span<const ShownMesh> before, const WantedOrder& wanted,
                                           std::size_t most);

}  // namespace ibr
