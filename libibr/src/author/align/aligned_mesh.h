// SPDX-License-Identifier: Apache-2.0
// A cell's mesh after alignment: folded triangles are reverted; lists, ranges and quality follow the moved points.
// Cells of pinholes and cells of panoramas share these steps.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "author/match/ranges.h"
#include "ibr/optimiser.h"
#include "ibr/scene.h"

namespace ibr::aligning {

using Match = std::vector<std::vector<glm::vec2>>;  // d × n, px
using Signs = std::function<std::uint32_t(const Match&, const glm::uvec3&)>;

/// True if the triangle is positive in the first image with its corners in the mesh's order. The grid stores judged
/// triangles positive (alignment_grid.h); corners of other triangles are swapped when they return to the mesh.
bool isUpright(const MorphMesh& mesh, const glm::uvec3& t);

/// Moves points back, in all images, where a triangle is folded over that was not before. Returns the number of points.
std::size_t revertFolded(const MorphMesh& mesh, Match& moved, const Signs& signs);

/// Moves points back as above, for a mesh `now` that has flipped edges and inserted points at the ends of its lists. If
/// a new triangle would then be folded over in an image or a mean, all flips and insertions are undone first. Uses only
/// matches and triangles of `now`.
std::size_t revertFolded(const MorphMesh& before, MorphMesh& now);

/// Flags of the points that moved in any image or were inserted.
std::vector<bool> movedPoints(const Match& before, const Match& after);

/// Indices of the triangles with a moved corner.
std::vector<std::size_t> movedTriangles(const MorphMesh& mesh, const std::vector<bool>& moved);

/// Indices of the triangles that are new or have other corners than in `before`.
std::vector<std::size_t> changedTriangles(const MorphMesh& before, const MorphMesh& now);

/// Sets ρ, a_i and uncertainty of moved points. `range`: n entries, used for moved points. `level`: n entries, as for
/// widenUncertainty; empty where uncertainties are not widened.
void updateRanges(MorphMesh& mesh, const std::vector<bool>& moved, std::span<const RangeFit> range,
                  std::span<const double> level);

/// Extends the per-point and per-triangle lists to the mesh's new points and triangles. New triangles get tier 0. New
/// points get the planes that all their parents share.
void extendLists(MorphMesh& mesh, std::span<const InsertedPoint> inserted);

/// Moves triangles of tier 0 before all others, and otherwise keeps their order.
void sortByTier(MorphMesh& mesh);

/// Quality with ECC, residual and score of the mesh. `residuals`: of its points. `area`: of a triangle, in any unit.
CellQuality qualityOf(const MorphMesh& mesh, CellQuality quality, std::vector<double> residuals,
                      const std::function<double(const glm::uvec3&)>& area);

}  // namespace ibr::aligning
