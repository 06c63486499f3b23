// SPDX-License-Identifier: Apache-2.0
// The working image: display-encoded RGBA8 and D32F depth. With two views, both images have two layers of one pass.
//
// Uses a VkRenderPass instead of dynamic rendering: the validation layer of Debian 12 (1.3.239) only detects hazards of
// attachments in render passes.
#pragma once

#include <vulkan/vulkan_core.h>

#include <array>
#include <vector>

#include "base/vulkan/gpu_image.h"
#include "base/vulkan/handle.h"
#include "ibr/device.h"

namespace ibr {

/// Synchronisation: between begin and end the pass owns the images. The pass waits for the previous frame's draws and
/// for earlier reads on the same queue by fragment and compute shaders or transfers. So one canvas serves any number of
/// frames in flight. After `end` both images are in use::kSampled: reads by fragment shaders need no further barrier,
/// other reads go through transition(…, use::kSampled, …).
class Canvas {
 public:
  static constexpr VkFormat kColourFormat = VK_FORMAT_R8G8B8A8_UNORM;
  static constexpr VkFormat kDepthFormat = VK_FORMAT_D32_SFLOAT;

  /// `extraUsage`: usage of the colour image besides drawing, sampling and copying from it. `layers`: with 2, every
  /// draw goes into both layers, with gl_ViewIndex 0 and 1 (VK_KHR_multiview).
  Canvas(const Device& device, VkExtent2D largest, VkImageUsageFlags extraUsage = 0, std::uint32_t layers = 1);

  VkRenderPass renderPass() const noexcept { return renderPass_.get(); }  // subpass 0: one colour attachment and depth
  VkExtent2D largest() const noexcept { return colour_.info().extent; }

  /// Begins the pass on the corner [0, extent) of the canvas, with colour cleared to `clear` and depth to 1. The rest
  /// becomes undefined. `extent` is at most `largest`. The caller sets viewport and scissor.
  void begin(VkCommandBuffer commands, VkExtent2D extent, const std::array<float, 4>& clear) const noexcept;
  void end(VkCommandBuffer commands) const noexcept;

  VkImage colour() const noexcept { return colour_.get(); }
  VkImageView colourView(std::uint32_t layer = 0) const noexcept { return viewOf(colour_, layer, 0); }
  VkImage depth() const noexcept { return depth_.get(); }
  VkImageView depthView(std::uint32_t layer = 0) const noexcept { return viewOf(depth_, layer, 1); }
  VkDeviceSize bytes() const noexcept {  // size of the texels
    return VkDeviceSize(8) * colour_.info().layers * largest().width * largest().height;
  }
  VkDeviceSize allocatedBytes() const noexcept { return colour_.allocatedBytes() + depth_.allocatedBytes(); }

 private:
  VkImageView viewOf(const GpuImage& image, std::uint32_t layer, std::size_t which) const noexcept {
    return layerViews_.empty() ? image.view() : layerViews_[2 * layer + which].get();
  }

  GpuImage colour_, depth_;
  std::vector<ImageViewHandle> layerViews_;  // with two layers: colour, depth, colour, depth
  RenderPassHandle renderPass_;
  FramebufferHandle framebuffer_;
};

}  // namespace ibr
