// SPDX-License-Identifier: Apache-2.0
// ECC optimisation of a scene's cells ([T] chapter 3): everything around the optimiser of one alignment
// (ibr/optimiser.h). Needs ibr::author, which knows no device: the optimiser is handed in.
//
//   optimiseScene({"scene", "sharper"}, [&](Alignment& a, const AlignmentOptions& o, const ProgressCallback& p) {
//     return align(a, o, nullptr, p);
//   });
//
// Matches of tier 0 are moved; a point that did not move keeps every number that it had. Of points that moved, ρ, a_i
// and uncertainty are found again, as building finds them. Tiers, poses, photographs and backdrops stay; triangles do,
// unless edges are flipped (AlignmentOptions::flipEdges; not in cells of panoramas), which leaves their number, or
// points are inserted (AlignmentOptions::insertPoints; neither), which come after all others, their triangles last of
// tier 0.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "ibr/log.h"
#include "ibr/optimiser.h"
#include "ibr/scene.h"

namespace ibr {

/// align() with its device, if it needs one. Called from threads of the library; from several at once for the methods
/// that run on the processor.
using Aligner = std::function<AlignmentSummary(Alignment&, const AlignmentOptions&, const ProgressCallback&)>;

struct OptimiseCellsOptions {
  AlignmentOptions alignment;      // `threads` and `guard` are set for each cell: a move is refused where rays part
                                   // after it or miss their point by more than 3 px, if they did not before
  std::vector<std::size_t> cells;  // numbers of those that are optimised; empty: all
  int threads = 0;                 // of the processor; 0 = all cores
  std::filesystem::path finished;  // folder in which finished cells are kept, so that a stopped run goes on; "": none
};

struct OptimiseSceneOptions {
  std::filesystem::path scene;   // folder
  std::filesystem::path output;  // another one; made if missing
  OptimiseCellsOptions cells;    // `finished` empty: in the output, until it is finished
};

struct OptimisedCell {
  std::size_t cell = 0;              // its number
  std::vector<std::string> members;  // names of the photographs
  int width = 0, height = 0;         // px, of the first one
  std::size_t points = 0;            // without those that were inserted
  std::size_t judged = 0;    // triangles, of a panorama's cell in the faces of the cube on which it is optimised
  std::size_t fixed = 0;     // points that must not move: their star does not lie on the grid, or in one face of a cube
  std::size_t moved = 0;     // points
  std::size_t flipped = 0;   // triangles that have other corners, without those around inserted points
  std::size_t inserted = 0;  // points
  std::size_t takenBack = 0;  // points that moved and went back, lest a triangle that is not judged turns over
  AlignmentSummary summary;   // ECCs are NaN where no triangle is judged
  double seconds = 0;
  bool resumed = false;  // taken from a run that was stopped
};

struct OptimiseSceneReport {
  std::vector<OptimisedCell> cells;  // by number
  double seconds = 0;
};

/// Optimises cells of a scene in memory; its photographs are read from its folder. On the processor cells run side by
/// side, otherwise one after another; the result does not depend on it. Throws Error (invalidInput, io, and what the
/// optimiser throws); then the scene is as it was.
OptimiseSceneReport optimiseCells(Scene& scene, const OptimiseCellsOptions& options, const Aligner& aligner,
                                  const ProgressCallback& progress = {}, const LogCallback& log = {});

/// Reads a scene, optimises its cells and writes it to another folder. Photographs and textures become further links to
/// the same files, or copies where the file system has no links. A run that was stopped goes on when it is called again
/// with the same options. Throws Error.
OptimiseSceneReport optimiseScene(const OptimiseSceneOptions& options, const Aligner& aligner,
                                  const ProgressCallback& progress = {}, const LogCallback& log = {});

}  // namespace ibr
