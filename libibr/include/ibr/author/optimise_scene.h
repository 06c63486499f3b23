// SPDX-License-Identifier: Apache-2.0
// ECC optimisation of a scene's cells ([T] chapter 3) by the optimiser of one alignment (ibr/optimiser.h). Needs
// ibr::author, which uses no device; the caller passes the optimiser.
//
//   optimiseScene({"scene", "sharper"}, [&](Alignment& a, const AlignmentOptions& o, const ProgressCallback& p) {
//     return align(a, o, nullptr, p);
//   });
//
// The optimiser moves points of tier 0. For moved points, ρ, a_i and uncertainty are computed again as in a build;
// other points keep all their values. Tiers, poses, photographs and backdrops do not change; confirmations and
// consensus of the cells are cleared. Triangles change only by AlignmentOptions::flipEdges, which keeps their number,
// and by insertPoints, but not in cells of panoramas. Inserted points come after all others, their triangles last of
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

/// Calls align(), with a device if needed. Called from threads of the library, and from several threads at once for
/// methods that run on the CPU.
using Aligner = std::function<AlignmentSummary(Alignment&, const AlignmentOptions&, const ProgressCallback&)>;

/// Options of optimiseCells().
struct OptimiseCellsOptions {
  AlignmentOptions alignment;  // options of align(); `threads` and `guard` are set for each cell. The guard refuses a
                               // move if rays then diverge or miss their point by more than 3 px, and did not before
  std::vector<std::size_t> cells;     // indices into Scene::cells; empty: all
  int threads = 0;                    // threads of the CPU; 0: all cores
  std::filesystem::path cacheFolder;  // folder in which finished cells are cached, so that a stopped run resumes;
                                      // empty: no cache
};

/// Options of optimiseScene().
struct OptimiseSceneOptions {
  std::filesystem::path scene;   // folder of the scene
  std::filesystem::path output;  // another folder, for the result; created if missing
  OptimiseCellsOptions cells;    // for all cells; `cacheFolder` empty: the cache is in the output until the run ends
};

/// Report of one cell.
struct OptimisedCell {
  std::size_t cell = 0;              // index into Scene::cells
  std::vector<std::string> members;  // names of the photographs
  int width = 0, height = 0;         // size of the first photograph, px
  std::size_t points = 0;            // number of points, without inserted ones
  std::size_t evaluated = 0;         // number of triangles whose ECC is optimised; of panoramas, summed over cube faces
  std::size_t fixed = 0;  // number of points that must not move, since their triangles do not fit the 1/128 px grid or
                          // a cube face
  std::size_t moved = 0;  // number of moved points
  std::size_t flipped = 0;   // number of triangles with other corners, without those around inserted points
  std::size_t inserted = 0;  // number of inserted points
  std::size_t reverted = 0;  // number of points moved back, since an unevaluated triangle would turn over
  AlignmentSummary summary;  // result of align(); ECCs are NaN if no triangle is evaluated
  double seconds = 0;        // elapsed time
  bool cached = false;       // true: read from the cache of a stopped run
};

/// Report of optimiseCells() and optimiseScene().
struct OptimiseSceneReport {
  std::vector<OptimisedCell> cells;  // optimised cells, ascending by index
  double seconds = 0;                // elapsed time
};

/// Optimises cells of a scene in memory; reads the photographs from the scene's folder. Cells run in parallel for
/// methods on the CPU, else one after another; the result does not depend on this. Throws Error (invalidInput, io,
/// cancelled, and what the optimiser throws); then the scene is unchanged.
OptimiseSceneReport optimiseCells(Scene& scene, const OptimiseCellsOptions& options, const Aligner& aligner,
                                  const ProgressCallback& progress = {}, const LogCallback& log = {});

/// Reads a scene, optimises its cells and writes the scene to another folder. Photographs and textures become hard
/// links to the same files, or copies if the file system has no hard links. A stopped run resumes when it is called
/// again with the same options. Throws Error.
OptimiseSceneReport optimiseScene(const OptimiseSceneOptions& options, const Aligner& aligner,
                                  const ProgressCallback& progress = {}, const LogCallback& log = {});

}  // namespace ibr
