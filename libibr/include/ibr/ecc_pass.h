// SPDX-License-Identifier: Apache-2.0
// The optimiser's evaluation as a recorder ([T] §3.6): evaluates and moves the points of one mesh in the caller's
// command buffer. For callers with their own loop; the paper's loop is align() in ibr/optimiser.h.
//
//   EccPass pass(device, alignment, options);
//   for each cycle, picture, class:  pass.recordMove(commands, {picture, k, radiusPx, seed});
//   pass.recordEvaluation(commands);
//   pass.recordReadback(commands);   … the caller submits and waits …
//   pass.positions(), pass.stars()
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "ibr/export.h"
#include "ibr/optimiser.h"
#include "ibr/uploads.h"

namespace ibr {

/// One move of a class of points, for EccPass::recordMove().
struct EccMove {
  std::uint32_t picture = 0;     // picture in which points move, index into Alignment::pictures
  std::uint32_t pointClass = 0;  // class of points that share no triangle, < EccPass::classCount()
  double radiusPx = 5;           // R, maximum displacement; (0, 64]
  std::uint32_t seed = 0;        // same positions, seed and options: same moves on every device
};

/// ECC of a point's triangles, with one picture as the source and all others as targets.
struct EccStar {
  double channels = 0, concatenated = 0;  // by the EccDefinition of the same name; 0 where undefined
  std::uint64_t pixels = 0;               // pairs of samples; 0: the point has no triangle
};

/// Records moves and evaluations of one mesh. Move-only; the device must outlive it. One thread at a time uses it, with
/// at most one submission in flight.
class IBR_API EccPass {
 public:
  /// Uploads mesh, pictures and positions: submits to the device's queue and waits, unless `uploads` collect the
  /// uploads. Uses the options instances, definition, varianceFloor, rigidity, prune and scaledInstances. The alignment
  /// need not outlive the call. Throws Error: invalidInput as align(); unsupported without Device::supportsInt64, or
  /// where the pictures exceed the device's largest storage buffer; outOfMemory, deviceLost.
  EccPass(const Device& device, const Alignment& alignment, const AlignmentOptions& options = {},
          Uploads* uploads = nullptr);
  EccPass(EccPass&&) noexcept;
  EccPass& operator=(EccPass&&) noexcept;
  ~EccPass();  // frees device memory; does not wait

  /// Returns the number of classes. Points of one class share no triangle, so that they may move together.
  std::uint32_t classCount() const noexcept;

  /// Moves each point of the class to the best of its candidates. Records one dispatch and a barrier to later commands
  /// of this pass, outside a render pass.
  void recordMove(VkCommandBuffer commands, const EccMove& move) const noexcept;

  /// Evaluates all points at their current positions, in all pictures. Records one dispatch per picture and a barrier.
  void recordEvaluation(VkCommandBuffer commands) const noexcept;

  /// Copies positions and evaluations to host memory, which positions() and stars() read once the submission has
  /// finished. Without a recordEvaluation before it, stars() returns the results of an earlier one or undefined values.
  void recordReadback(VkCommandBuffer commands) const noexcept;

  std::vector<std::vector<glm::ivec2>> positions() const;  // current positions by picture and point, 1/128 px
  std::vector<std::vector<EccStar>> stars() const;         // evaluations by picture and point

 private:
  struct IBR_LOCAL State;
  std::unique_ptr<State> state_;
};

}  // namespace ibr
