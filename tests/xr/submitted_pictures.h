// SPDX-License-Identifier: Apache-2.0
// The pictures in the images that a program submits, read back from its swapchains when somebody wants them.
#pragma once

#define XR_USE_GRAPHICS_API_VULKAN
#include <vulkan/vulkan.h>
// After the types that it builds on.
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
  /// Where the folder holds a file "wanted", the next frame's pictures are written beside it as eye0 and eye1 ("width
  /// height format" in a line, then the pixels' four bytes), and the file is removed. An empty name: never.
  explicit SubmittedPictures(std::filesystem::path folder) : folder_(std::move(folder)) {}

  bool active() const { return !folder_.empty(); }
  void session(const XrSessionCreateInfo& info);
  void swapchain(XrSwapchain swapchain, PFN_xrEnumerateSwapchainImages enumerate);
  /// Before the runtime is told of the frame.
  void frame(const XrFrameEndInfo& info, const FrameRecord& record) const;

 private:
  void write(const XrCompositionLayerProjection& layer, const FrameRecord& record) const;

  std::filesystem::path folder_;
  PictureTap tap_;
  std::map<XrSwapchain, std::vector<VkImage>> images_;
};

}  // namespace ibr::test
