// SPDX-License-Identifier: Apache-2.0
// Runs the optimiser (ibr/author/optimise_scene.h) on one cell: puts the mesh onto the grid, aligns the mesh, converts
// the result back, and recomputes ranges, labels and quality of the moved points.
#pragma once

#include <span>

#include "author/match/match.h"
#include "ibr/author/optimise_scene.h"

namespace ibr {

/// Input of the optimiser: images and cameras at the stored size. Both must outlive the call.
struct CellAlignmentInput {
  std::span<const MatchView> views;
  const Cell& cell;
};

struct AlignedCell {
  MorphMesh mesh;
  CellQuality quality;
  OptimisedCell facts;  // without cell, members and seconds
};

/// Aligns a cell whose members are all pinholes or all panoramas.
AlignedCell alignCell(const CellAlignmentInput& input, const AlignmentOptions& options, const Aligner& aligner,
                      const ProgressCallback& progress);

/// Aligns a cell of panoramas on the faces of a cube (panorama_faces.h) that has the same orientation for all members.
/// A point moves only in the face that contains the point, and only if all its triangles lie well inside that face in
/// all members. Ignores options.flipEdges and options.insertPoints.
AlignedCell alignPanoramas(const CellAlignmentInput& input, const AlignmentOptions& options, const Aligner& aligner,
                           const ProgressCallback& progress);

/// Aligns a cell of pinholes. Triangles that may contain masked pixels do not move.
AlignedCell alignPinholes(const CellAlignmentInput& input, const AlignmentOptions& options, const Aligner& aligner,
                          const ProgressCallback& progress);

}  // namespace ibr
