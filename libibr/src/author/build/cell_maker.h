// SPDX-License-Identifier: Apache-2.0
// Matches, meshes and caches one cell at a time, or reads the cell from the cache of an earlier build.
//
// A finished cell is cached under a hash of its members' files, cameras and points, and of the options that it depends
// on. A stopped build resumes from the cache, and a later build with other options reuses all unchanged cells.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "author/build/build_cost.h"
#include "author/build/build_input.h"
#include "author/depth/photograph_depth.h"
#include "author/match/frame_depth.h"
#include "author/match/match.h"
#include "author/mesh/mesh.h"

namespace ibr {

struct CellResult {
  CellMesh cell;
  double seconds = 0, cpuSeconds = 0;
  bool cached = false;    // read from the cache
  std::uint64_t key = 0;  // of the cache file
  MatchMethod matcher = MatchMethod::sweep;
};

/// A photograph at its matched size. If the photograph is larger and `whole` is set, `whole` gets the full-size grey
/// image.
MatchView viewOf(const Photograph& photograph, Image8* whole = nullptr);

/// Cameras at the matched size. Poses are adjusted only where matching would fail with them, since views that fit the
/// model's poses render better. The scene stores the model's poses. Precondition: no panoramas.
std::vector<Camera> camerasToMatch(const BuildInput& input, const std::vector<std::uint32_t>& members);

/// Confirmed depth of a photograph. Thread-safe.
using MemberDepths = std::function<MemberDepth(std::uint32_t photograph)>;

/// Confirmed depth (filteredDepth) from the depth of all photographs, which must outlive the result.
MemberDepths memberDepths(std::span<const PhotographDepth> depths);

class CellMaker {
 public:
  /// `input` and `options` must outlive the object. Cells with MatchMethod::sweep use the `depths` of their members.
  /// Empty: the cells are swept.
  CellMaker(const BuildInput& input, const BuildOptions& options, MemberDepths depths = {})
      : input_(input), options_(options), depths_(std::move(depths)) {}

  /// `members`: 2 to 4 photographs, all panoramas or none. Thread-safe. Throws Error.
  CellResult make(const std::vector<std::uint32_t>& members) const;

  /// Work of make(), for predictions. Approximate for cells whose points lie behind them.
  CellWork work(const std::vector<std::uint32_t>& members) const;

 private:
  // False: cells take the depth of their members.
  bool sweepsCells() const { return input_.refinesPoses && input_.refine; }

  const BuildInput& input_;
  const BuildOptions& options_;
  MemberDepths depths_;
};

}  // namespace ibr
