// SPDX-License-Identifier: Apache-2.0
// Mirrors one eye's image in a window.
#pragma once

#include "base/vulkan/gpu_image.h"
#include "ibr/device.h"
#include "ibr/target.h"
#include "window/swapchain.h"

namespace ibr::app {

/// An eye's image: one layer of an image with transfer source usage.
struct MirrorSource {
  VkImage image;
  std::uint32_t layer = 0;
  VkRect2D rect{};                        // of the eye's image within the layer
  ImageUse use = use::kColourAttachment;  // of the layer, before and after
};

class Mirror {
 public:
  /// For sources of `format` with images of at most `most`. Throws Error: unsupported if rawFormat (window/raw_copy.h)
  /// does not know the format, outOfMemory.
  Mirror(const Device& device, VkFormat format, VkExtent2D most);

  /// Records the image into the middle of a window's frame, scaled to fit, with bars beside it. Swapchain::end needs no
  /// other commands. Display-encoded values are kept except for scaling. Submit the frame on the queue after the source
  /// was drawn and before the runtime gets the source back.
  void record(VkCommandBuffer commands, const MirrorSource& source, const Swapchain::Frame& frame) const noexcept;

 private:
  GpuImage values_;
};

/// Returns the largest centred rectangle with the picture's aspect in the window, at least a pixel. No side may be 0.
VkRect2D letterbox(VkExtent2D picture, VkExtent2D window) noexcept;

}  // namespace ibr::app
