// SPDX-License-Identifier: Apache-2.0
// What a build will take, before it begins: a model of its stages' costs, whose constants were measured on one machine,
// times how fast this one does a little of the same work right now (machine_speed.h).
//
// Depth of photographs is by far the most of it, or, where that is not found, matching of cells. Of a cell's frame of
// P px with m members: P·(a + b·m) for what is done once a pixel; where it is swept over L levels at a quarter of the
// pixels, P·L·(c + d·m) for that and the semi-global paths.
#pragma once

#include <cstddef>
#include <vector>

#include "ibr/author.h"

namespace ibr {

/// Of one cell.
struct CellWork {
  double pixels = 0;  // of the frame in which it is matched
  double levels = 0;  // of the sweep; 0: it has its members' depth
  std::size_t members = 0;
  double readPixels = 0;    // of the members' files
  double loadingBytes = 0;  // of memory, while one member is read
  double beyondPixels = 0;  // of one member, beyond those that are matched
  bool swept = true;        // if not, matched by flow, by homographies, or of panoramas
};

/// All that a build has to do. Pixels are summed over photographs.
struct BuildWork {
  std::size_t photographs = 0;
  double readPixels = 0;         // of the files
  double storedPixels = 0;       // of which textures are made
  double encodedPixels = 0;      // of pictures that are written anew, not copied
  double featurePixels = 0;      // in which features are looked for
  std::size_t pairs = 0;         // whose features are matched
  double judgedSweptPixels = 0;  // of depth, by which moving objects are found
  double judgedPixels = 0,
         judgePixels = 0;  // that are matched, where movers are sought: of photographs, of their judges
  std::vector<CellWork> cells;
  bool exposures = false;  // are compared
  double refinedBy = 0;    // observations by which poses are refined; 0: they are not
  std::size_t backdrops = 0;
  double backdropPixels = 0;  // at the backdrops' size
  double sweptPixels = 0;     // in which depth is found
  double refinements = 1;     // of depth, in those of DepthSearch::refined
};

/// How much longer than the machine of the constants this one takes for the same work: of one thread's processor time,
/// and of the time that passes, while `threads` do it side by side.
struct MachineSpeed {
  double processor = 1, passing = 1;
};

struct StageCost {
  const char* stage;
  double processorSeconds;  // of all threads
  double seconds;
};

/// The stages of a build in their order, those without work left out. `threads`: as many as run jobs side by side in
/// the stage of storing, of features, of cells, of backdrops, of movers.
struct StageThreads {
  int storing = 1, features = 1, cells = 1, backdrops = 1, movers = 1;
};
std::vector<StageCost> costOf(const BuildWork& work, const StageThreads& threads, TextureFormat texture,
                              const MachineSpeed& speed);

/// Bytes of memory that making the cell takes, at most; of the sweep mostly its volume of costs and of their sums.
double bytesToMake(const CellWork& cell);

/// Bytes of memory, beside the photographs' depth and a photograph for each thread.
double bytesToCompareExposures(const BuildWork& work);

/// Bytes of memory that the meshes of finished cells take, about, and of the disk.
double bytesKept(const CellWork& cell);

}  // namespace ibr
