// SPDX-License-Identifier: Apache-2.0
// Draws shapes over an eye's picture, before and behind what was photographed ([T] §2.5.5). What lies behind shows
// faintly through: the ground that a mark stands on is only about where photographs say it is.
#pragma once

#include <array>
#include <cstdint>

#include "gpu/device/handle.h"
#include "gpu/transfer/buffer.h"
#include "ibr/target.h"
#include "vr/walk/shapes.h"

namespace ibr::app {

class ShapesPass {
 public:
  /// For targets of these formats; `slots` frames are in flight at once.
  ShapesPass(const Device& device, VkFormat colour, VkFormat depth, std::uint32_t slots);

  /// The shapes of a frame, which `record` draws. What was given with this slot before is no longer in use.
  void setShapes(std::uint32_t slot, const Shapes& shapes);

  /// Outside a render pass. The target, which has a depth, holds a picture: it is in use::kColourAttachment and its
  /// depth in use::kDepthAttachment, and so they are left; what stands in the room has its depth. `eye`: in tracking
  /// space, metres; the depth's planes are nearPlane and farPlane metres away.
  void record(VkCommandBuffer commands, std::uint32_t slot, const Camera& eye, const Target& target, double nearPlane,
              double farPlane) const noexcept;

 private:
  struct Slot {
    Buffer vertices;
    std::uint32_t inSpace = 0, onView = 0;  // how many
  };

  const Device& device_;
  PipelineLayoutHandle layout_;
  PipelineHandle tested_, untested_;
  std::vector<Slot> slots_;
};

}  // namespace ibr::app
