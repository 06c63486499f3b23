// SPDX-License-Identifier: Apache-2.0
// The working image: display-encoded RGBA8 and D32F depth.
//
// Drawn with a VkRenderPass and not by dynamic rendering, because the validation layer of Debian 12 (1.3.239) sees
// hazards of attachments only there.
#pragma once

#include <vulkan/vulkan_core.h>

#include <array>

#include "gpu/gpu_image.h"
#include "gpu/handle.h"
#include "ibr/device.h"

namespace ibr {

/// Synchronisation: between begin and end the pass has the images for itself. It waits for the draws of the frame
/// before and for all reads in fragment and compute shaders or by transfers that were submitted earlier to the same
/// queue, so one canvas serves any number of frames in flight. After `end` both images are in use::kSampled: reads by
/// fragment shaders need no further barrier, others go through transition(…, use::kSampled, …).
class Canvas {
 public:
  static constexpr VkFormat kColourFormat = VK_FORMAT_R8G8B8A8_UNORM;
  static constexpr VkFormat kDepthFormat = VK_FORMAT_D32_SFLOAT;

  /// `furtherUse`: of the colour image, beyond drawing, sampling and being copied from.
  Canvas(const Device& device, VkExtent2D largest, VkImageUsageFlags furtherUse = 0);

  VkRenderPass renderPass() const noexcept { return renderPass_.get(); }  // subpass 0: one colour attachment and depth
  VkExtent2D largest() const noexcept { return colour_.info().extent; }

  /// Begins the pass on the corner [0, extent) of the canvas, colour cleared to `clear` and depth to 1; what lies
  /// outside becomes undefined. `extent` is at most `largest`. Viewport and scissor are the caller's to set.
  void begin(VkCommandBuffer commands, VkExtent2D extent, const std::array<float, 4>& clear) const noexcept;
  void end(VkCommandBuffer commands) const noexcept;

  VkImage colour() const noexcept { return colour_.get(); }
  VkImageView colourView() const noexcept { return colour_.view(); }
  VkImage depth() const noexcept { return depth_.get(); }
  VkImageView depthView() const noexcept { return depth_.view(); }
  VkDeviceSize bytes() const noexcept { return VkDeviceSize(8) * largest().width * largest().height; }  // of texels
  VkDeviceSize allocatedBytes() const noexcept { return colour_.allocatedBytes() + depth_.allocatedBytes(); }

 private:
  GpuImage colour_, depth_;
  RenderPassHandle renderPass_;
  FramebufferHandle framebuffer_;
};

}  // namespace ibr
