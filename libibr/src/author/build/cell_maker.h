// SPDX-License-Identifier: Apache-2.0
// One cell after another: matched, meshed and kept, or taken from a build that was stopped.
//
// A finished cell is kept until the scene is written, under a hash of its members' files, cameras and points, so that a
// build that was stopped goes on, and one with other options takes over what is the same.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "author/build/build_cost.h"
#include "author/build/build_input.h"
#include "author/depth/photograph_depth.h"
#include "author/match/match.h"
#include "author/mesh/mesh.h"

namespace ibr {

struct MadeCell {
  CellMesh cell;
  double seconds = 0, processorSeconds = 0;
  bool resumed = false;   // was kept
  std::uint64_t key = 0;  // it is kept under
  MatchMethod matcher = MatchMethod::sweep;
};

/// A photograph at the size at which it is matched. Where that is smaller than the photograph, `whole` gets all of it
/// in grey, if it is wanted.
MatchView viewOf(const Photograph& photograph, Image8* whole = nullptr);

/// At the size that is matched. Where poses are so far off that matching would fail they are adjusted: below that, what
/// fits the model's poses renders better, and what is stored keeps the model's. Precondition: no panoramas.
std::vector<Camera> camerasToMatch(const BuildInput& input, const std::vector<std::uint32_t>& members);

class CellMaker {
 public:
  /// All outlive the object. `depths`: of all photographs, as depthOfPhotographs gives them; cells that are matched by
  /// MatchMethod::sweep have the depth that their members keep. Empty: it is swept.
  CellMaker(const BuildInput& input, const BuildOptions& options, std::span<const PhotographDepth> depths = {})
      : input_(input), options_(options), depths_(depths) {}

  /// `members`: 2 to 4 photographs, all panoramas or none. May be called from several threads. Throws Error.
  MadeCell make(const std::vector<std::uint32_t>& members) const;

  /// What making one has to do. Of panoramas, and of cells whose points lie behind them, roughly.
  CellWork work(const std::vector<std::uint32_t>& members) const;

 private:
  const BuildInput& input_;
  const BuildOptions& options_;
  std::span<const PhotographDepth> depths_;
};

}  // namespace ibr
