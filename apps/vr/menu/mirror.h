// SPDX-License-Identifier: Apache-2.0
// What one eye sees, in a window beside the headset.
#pragma once

#include "gpu/transfer/gpu_image.h"
#include "ibr/device.h"
#include "ibr/target.h"
#include "window/swapchain.h"

namespace ibr::app {

/// An eye's picture, in one layer of an image that transfers may read.
struct MirrorSource {
  VkImage image;
  std::uint32_t layer = 0;
  VkRect2D rect{};                        // of the picture in it
  ImageUse use = use::kColourAttachment;  // of the layer, before and after
};

class Mirror {
 public:
  /// For sources of that format whose pictures are at most so large. Throws Error: unsupported where the format's
  /// values are not display-encoded ones (rawFormat in window/raw_copy.h knows it), outOfMemory.
  Mirror(const Device& device, VkFormat format, VkExtent2D most);

  /// Records the whole picture into the middle of a window's frame, as large as fits, bars beside it: all that the
  /// frame needs before Swapchain::end. Values stay as they are but for scaling. The frame is to be submitted on the
  /// queue after what draws the source, and before a runtime takes the source back.
  void record(VkCommandBuffer commands, const MirrorSource& source, const Swapchain::Frame& frame) const noexcept;

 private:
  GpuImage values_;
};

/// Where a picture lies in a window that shows all of it as large as it can. At least a pixel; neither is empty.
VkRect2D letterbox(VkExtent2D picture, VkExtent2D window) noexcept;

}  // namespace ibr::app
