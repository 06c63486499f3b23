// SPDX-License-Identifier: Apache-2.0
// One cycle of an alignment: every point tries its candidates in every picture ([T] fig. 16, lines 5–17). The methods
// are ways to do this; the loop around them is align().
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "optimise/judge.h"
#include "optimise/star_mesh.h"

namespace ibr {

struct CycleRequest {
  int radius = 0;          // R, 1/128 px
  std::uint32_t seed = 0;  // of the cycle
};

struct CycleCounts {
  std::uint64_t mutations = 0, pixels = 0;
  std::size_t moved = 0, refused = 0;
};

/// Asked now and then whether to go on; throws Error{cancelled}.
using KeepGoing = std::function<void()>;

class Mover {
 public:
  virtual ~Mover() = default;

  /// Moves points of `at`, for each picture class after class (StarMesh::colours), and asks the guard.
  virtual CycleCounts cycle(const CycleRequest& request, Positions& at, const KeepGoing& keepGoing) = 0;

  /// Judgement of every point where it stands, picture after picture: d × n. Points without a star: no pixels.
  virtual std::vector<Judgement> judgeAll(const Positions& at) = 0;

  /// How many of the first cycles see less than the pictures have: what they gain ends no loop.
  virtual int coarseCycles() const { return 0; }
};

/// What every mover is made from; all of it outlives the mover.
struct MoverInput {
  const StarMesh& mesh;
  const std::vector<Texels>& pictures;
  const AlignmentOptions& options;
  const Alignment& alignment;  // as it was before the first cycle
};

std::unique_ptr<Mover> cpuMover(const MoverInput& input);
std::unique_ptr<Mover> gradientMover(const MoverInput& input);
std::unique_ptr<Mover> computeMover(const MoverInput& input, const Device& device);
std::unique_ptr<Mover> rasterMover(const MoverInput& input, const Device& device);

/// Where a point stands in all pictures.
std::vector<glm::ivec2> matchOf(const Positions& at, std::uint32_t point);

/// A point that has been moved in one picture.
struct Moved {
  std::uint32_t point;
  glm::ivec2 from;
};

/// Takes back what the guard refuses, and counts it.
void askGuard(const AlignmentGuard& guard, std::span<const Moved> moved, std::size_t member, Positions& at,
              CycleCounts& counts);

}  // namespace ibr
