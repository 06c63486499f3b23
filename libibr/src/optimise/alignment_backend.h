// SPDX-License-Identifier: Apache-2.0
// One cycle of an alignment: every point tries its candidates in every image ([T] fig. 16, lines 5–17). Each method
// is an implementation of AlignmentBackend; align() is the loop around them.
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

/// Called periodically; throws Error{cancelled} to stop.
using KeepGoing = std::function<void()>;

class AlignmentBackend {
 public:
  virtual ~AlignmentBackend() = default;

  /// Moves points of `at`, for each image class by class (StarMesh::colours), and calls the guard.
  virtual CycleCounts cycle(const CycleRequest& request, Positions& at, const KeepGoing& keepGoing) = 0;

  /// Judges every point at its position, image by image: d × n. Points without a star have no pixels.
  virtual std::vector<Judgement> judgeAll(const Positions& at) = 0;

  /// Number of first cycles that run on blurred images. Their gain does not count for the stop criterion.
  virtual int coarseCycles() const { return 0; }
};

/// Input of all movers; must outlive the mover.
struct BackendInput {
  const StarMesh& mesh;
  const std::vector<Texels>& pictures;
  const AlignmentOptions& options;
  const Alignment& alignment;  // state before the first cycle
};

std::unique_ptr<AlignmentBackend> makeCpuBackend(const BackendInput& input);
std::unique_ptr<AlignmentBackend> makeGradientBackend(const BackendInput& input);
std::unique_ptr<AlignmentBackend> makeComputeBackend(const BackendInput& input, const Device& device);
std::unique_ptr<AlignmentBackend> makeRasterBackend(const BackendInput& input, const Device& device);

/// Positions of a point in all images.
std::vector<glm::ivec2> matchOf(const Positions& at, std::uint32_t point);

/// A point that was moved in one image, and its previous position.
struct Moved {
  std::uint32_t point;
  glm::ivec2 from;
};

/// Reverts the moves that the guard refuses, and counts them.
void applyGuard(const AlignmentGuard& guard, std::span<const Moved> moved, std::size_t member, Positions& at,
                CycleCounts& counts);

}  // namespace ibr
