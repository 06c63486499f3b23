// SPDX-License-Identifier: Apache-2.0
// Cost model of a build's stages, for predictions. The constants were measured on one machine. They are scaled by the
// present speed of this machine on a small sample of the same work (machine_speed.h).
//
// Depth of photographs dominates; without it, matching of cells does. A cell's frame of P px with m members costs P·(a
// + b·m) for work done once per pixel. A sweep over L levels at a quarter of the pixels adds P·L·(c + d·m), semi-global
// paths included.
//
// Panoramas are swept and matched by the faces of a cube: a cell has six frames, and the sweeps of faces have more
// levels than those of most photographs.
#pragma once

#include <cstddef>
#include <vector>

#include "ibr/author/build.h"

namespace ibr {

/// Number of levels of a sweep for which the constants were measured.
inline constexpr double kUsualSweepLevels = 48;

/// Work of one cell.
struct CellWork {
  double pixels = 0;  // of the frame in which the cell is matched
  double levels = 0;  // of the sweep; 0: the depth of the members is used
  std::size_t members = 0;
  double readPixels = 0;    // of the members' files
  double loadingBytes = 0;  // memory while one member is read
  double excessPixels = 0;  // of one member: its pixels that exceed the matched size
  bool swept = true;        // false: matched by flow or homographies, or panoramas
  // Of panoramas:
  double faces = 0;          // frames of `pixels` each, which are matched in turn and held together
  double sampledPixels = 0;  // of the members' faces, all together
  double mapPixels = 0;      // of the members' depth maps, which are drawn into each face
  double heldPixels = 0;     // of the members' photographs, which are held meanwhile
};

/// Work of a build. Pixels are summed over photographs.
struct BuildWork {
  std::size_t photographs = 0;
  double readPixels = 0;           // of the files
  double storedPixels = 0;         // for which textures are made
  double encodedPixels = 0;        // of photographs that are encoded again, not copied
  double featurePixels = 0;        // in which features are searched
  std::size_t pairs = 0;           // pairs of photographs whose features are matched
  double comparedSweptPixels = 0;  // of the depth maps by which moving objects are found
  double comparedPixels = 0,
         comparisonPixels = 0;  // compared to find moving objects: of photographs, of their comparison photographs
  std::vector<CellWork> cells;
  std::vector<CellWork> sweptCells;   // matched before that, to refine poses
  bool exposures = false;             // exposures are compared
  double refinementObservations = 0;  // observations used to refine poses; 0: not refined
  std::size_t backdrops = 0;
  double backdropPixels = 0;    // at the backdrops' size
  double sweptPixels = 0;       // of the swept depth maps
  double sourcePoints = 0;      // points of all views, times the views that they are projected into to choose sources
  double extraSweptPixels = 0;  // equivalent cost of levels beyond kUsualSweepLevels
  double facePixels = 0;        // sampled from panoramas, to find the depth of their faces
  double refinements = 1;       // cost of refinement, in units of DepthSearch::refined's
};

/// Time that this machine takes, relative to the machine on which the constants were measured: CPU time of one thread,
/// and elapsed time while several threads work in parallel.
struct MachineSpeed {
  double cpu = 1, elapsed = 1;
};

struct StageCost {
  const char* stage;
  double cpuSeconds;  // of all threads
  double seconds;
};

/// Number of parallel jobs in each stage.
struct StageThreads {
  int storing = 1, features = 1, cells = 1, backdrops = 1, movers = 1;
};

/// Returns the stages of a build in their order, without those that have no work.
std::vector<StageCost> costOf(const BuildWork& work, const StageThreads& threads, TextureFormat texture,
                              const MachineSpeed& speed);

/// Peak memory of making the cell, bytes. A sweep needs most of it for its cost volume and the volume's sums.
double bytesToMake(const CellWork& cell);

/// Memory for comparing exposures, bytes, in addition to the photographs' depth and one photograph per thread.
double bytesToCompareExposures(const BuildWork& work);

/// Approximate size of a cached cell mesh, bytes, both in memory and on disk.
double cachedCellBytes(const CellWork& cell);

}  // namespace ibr
