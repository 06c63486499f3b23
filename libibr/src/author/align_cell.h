// SPDX-License-Identifier: Apache-2.0
// One cell through the optimiser (ibr/optimise_scene.h): onto the grid, aligned, back, and all that follows from where
// its points stand.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "author/match.h"
#include "author/ranges.h"
#include "ibr/optimise_scene.h"

namespace ibr {

/// What is optimised: pictures and cameras at the stored size. Both outlive the call.
struct CellToAlign {
  std::span<const MatchView> views;
  const Cell& cell;
};

struct AlignedCell {
  MorphMesh mesh;
  CellQuality quality;
  OptimisedCell facts;  // without number, members and time
};

AlignedCell alignPinholes(const CellToAlign& input, const AlignmentOptions& options, const Aligner& aligner,
                          const ProgressCallback& progress);

/// Parts of it that cells of panoramas share.
namespace aligning {

using Match = std::vector<std::vector<glm::vec2>>;  // d × n, px
using Signs = std::function<std::uint32_t(const Match&, const glm::uvec3&)>;

/// Whether a move may stand, from what triangulation said before and after it.
bool allowed(const Range& before, const Range& after, double pixelsPerStored);

/// Moves back, in all pictures, what turns a triangle of the mesh over that was not. Gives the number of points.
std::size_t takeBackFolded(const MorphMesh& mesh, Match& moved, const Signs& signs);

/// n: whether a point stands elsewhere in any picture.
std::vector<bool> movedPoints(const Match& before, const Match& after);

/// Triangles with a corner that moved, by number.
std::vector<std::size_t> movedTriangles(const MorphMesh& mesh, const std::vector<bool>& moved);

/// ρ, a_i and uncertainty of what moved. `range`: n, of all points; `level`: n, as widenUncertainty has it, or none
/// where uncertainties are not widened.
void takeRanges(MorphMesh& mesh, const std::vector<bool>& moved, std::span<const Range> range,
                std::span<const double> level);

/// ECC, residual and score of what moved. `area`: of each triangle, in any unit.
CellQuality qualityOf(const MorphMesh& mesh, CellQuality quality, std::span<const Range> range,
                      const std::function<double(const glm::uvec3&)>& area);

}  // namespace aligning
}  // namespace ibr
