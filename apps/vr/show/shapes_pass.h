// SPDX-License-Identifier: Apache-2.0
// Draws shapes over an eye's image, with a depth test against the scene ([T] §2.5.5). Occluded shapes stay faintly
// visible, because the reconstructed ground below a mark is only approximately right.
#pragma once

#include <array>
#include <cstdint>

#include "base/vulkan/buffer.h"
#include "base/vulkan/handle.h"
#include "ibr/target.h"
#include "vr/walk/shapes.h"

namespace ibr::app {

class ShapesPass {
 public:
  /// For targets of these formats; `slots`: frames in flight.
  ShapesPass(const Device& device, VkFormat colour, VkFormat depth, std::uint32_t slots);

  /// Sets the shapes that `record` draws in this slot. The slot's previous frame must have finished.
  void setShapes(std::uint32_t slot, const Shapes& shapes);

  /// Call outside a render pass. The target must have a depth image and hold the drawn scene, in use::kColourAttachment
  /// and use::kDepthAttachment; both keep their uses. Shapes in space write their depth. `eye`: in tracking space,
  /// metres, with intrinsics of clipFromCamera(). nearPlane, farPlane: of the depth, metres; 0 < nearPlane < farPlane.
  void record(VkCommandBuffer commands, std::uint32_t slot, const Camera& eye, const Target& target, double nearPlane,
              double farPlane) const noexcept;

 private:
  struct Slot {
    Buffer vertices;
    std::uint32_t inSpace = 0, onView = 0;  // numbers of vertices
  };

  const Device& device_;
  PipelineLayoutHandle layout_;
  PipelineHandle tested_, untested_;
  std::vector<Slot> slots_;
};

}  // namespace ibr::app
