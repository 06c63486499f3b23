// SPDX-License-Identifier: Apache-2.0
// The optimiser's evaluation as a recorder ([T] §3.6): judges and moves the points of one mesh in the caller's command
// buffer, for callers with a loop of their own. align() in ibr/optimiser.h is the loop of the paper around it.
//
//   EccPass pass(device, alignment, options);
//   for each cycle, picture, class:  pass.recordMove(commands, {picture, k, radiusPx, seed});
//   pass.recordJudge(commands);
//   pass.recordReadback(commands);   … the caller submits and waits …
//   pass.positions(), pass.stars()
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "ibr/optimiser.h"

namespace ibr {

struct EccMove {
  std::uint32_t picture = 0;     // in which points move, < the alignment's pictures
  std::uint32_t pointClass = 0;  // < classCount(): points that share no triangle
  double radiusPx = 5;           // R; (0, 64]
  std::uint32_t seed = 0;        // same positions, seed and options: same moves, on every device
};

/// A point in one picture, against all others.
struct EccStar {
  double channels = 0, concatenated = 0;  // 0 where undefined
  std::uint64_t pixels = 0;               // pairs of samples; 0: the point has no triangle
};

/// Move-only; the device must outlive it. Used by one thread at a time, with one submission at a time in flight.
class EccPass {
 public:
  /// Uploads mesh, pictures and positions: submits to the device's queue and waits. Of the options, instances,
  /// definition, varianceFloor, rigidity, prune and scaledInstances count. The alignment may go afterwards. Throws
  /// Error: invalidInput as align(); unsupported where the device does not count in 64 bits (Device::counts64Bits) or
  /// the pictures exceed its largest storage buffer; outOfMemory, deviceLost.
  EccPass(const Device& device, const Alignment& alignment, const AlignmentOptions& options = {});
  EccPass(EccPass&&) noexcept;
  EccPass& operator=(EccPass&&) noexcept;
  ~EccPass();

  std::uint32_t classCount() const noexcept;

  /// Each point of the class moves to the best of its candidates. One dispatch; ends with a barrier to the next record
  /// of this pass. Outside a render pass.
  void recordMove(VkCommandBuffer commands, const EccMove& move) const noexcept;

  /// Judges all points where they stand, in all pictures. A dispatch a picture, and a barrier.
  void recordJudge(VkCommandBuffer commands) const noexcept;

  /// Copies positions and judgements to where positions() and stars() read them, once the submission is done. Without a
  /// recordJudge before it, what stars() says is of an earlier one or undefined.
  void recordReadback(VkCommandBuffer commands) const noexcept;

  std::vector<std::vector<glm::ivec2>> positions() const;  // picture × point, 1/128 px
  std::vector<std::vector<EccStar>> stars() const;         // picture × point

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ibr
