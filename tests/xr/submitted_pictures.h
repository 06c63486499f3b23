// SPDX-License-Identifier: Apache-2.0
// Reads back the images that a program submits from its swapchains, on request.
#pragma once

#define XR_USE_GRAPHICS_API_VULKAN
#include <vulkan/vulkan.h>
// After the types that openxr_platform.h uses.
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

#include <filesystem>
#include <map>
#include <vector>

#include "frame_record.h"
#include "picture_tap.h"

namespace ibr::test {

class SubmittedPictures {
 public:
  /// If the folder contains a file "wanted", the next frame's images are written there as eye0 and eye1 (a line "width
  /// height format", then four bytes a pixel), and "wanted" is removed. An empty name disables this.
  explicit SubmittedPictures(std::filesystem::path folder) : folder_(std::move(folder)) {}

  bool active() const { return !folder_.empty(); }
  void session(const XrSessionCreateInfo& info);
  void swapchain(XrSwapchain swapchain, PFN_xrEnumerateSwapchainImages enumerate);
  /// Called before the frame is passed to the runtime.
  void frame(const XrFrameEndInfo& info, const FrameRecord& record) const;

 private:
  void write(const XrCompositionLayerProjection& layer, const FrameRecord& record) const;

  std::filesystem::path folder_;
  PictureTap tap_;
  std::map<XrSwapchain, std::vector<VkImage>> images_;
};

}  // namespace ibr::test
