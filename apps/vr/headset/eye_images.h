// SPDX-License-Identifier: Apache-2.0
// The runtime's images for both eyes, as targets of a renderer: colour, and depth for the runtime's reprojection where
// it takes any (XR_KHR_composition_layer_depth). One image of two layers where the runtime has such, else one for each
// eye.
//
// Runtimes decode what they show from sRGB formats and take all others for linear. So a picture goes into an sRGB
// format as it is; where a runtime has none, into one of ours, from which a blit makes linear values. One thread.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "gpu/transfer/gpu_image.h"
#include "ibr/log.h"
#include "ibr/target.h"
#include "vr/headset/xr_session.h"

namespace ibr::app {

/// One of the runtime's swapchains, images of one or two layers.
class XrImages {
 public:
  XrImages() = default;
  XrImages(Headset& headset, const Device& device, const Session& session, VkFormat format, XrSwapchainUsageFlags usage,
           VkExtent2D extent, std::uint32_t layers);

  /// Takes the next image and waits until it may be written.
  void acquire(Headset& headset);
  void release(Headset& headset);

  XrSwapchain get() const noexcept { return swapchain_.get(); }
  VkImage image() const noexcept { return images_[current_].image; }  // the one that is acquired
  VkImageView view(std::uint32_t layer) const noexcept { return images_[current_].views[layer].get(); }
  VkFormat format() const noexcept { return format_; }

 private:
  struct Image {
    VkImage image;
    std::vector<ImageViewHandle> views;  // by layer
  };
  XrSwapchainOwner swapchain_;
  VkFormat format_ = VK_FORMAT_UNDEFINED;
  std::vector<Image> images_;
  std::uint32_t current_ = 0;
};

/// The format that pictures of 8 bits go into as they are, where the runtime has one.
std::optional<VkFormat> pictureFormat(const Session& session);

class EyeImages {
 public:
  /// Projection of the depth that is given to the runtime and to shapes, metres.
  static constexpr double kNearPlane = 0.05, kFarPlane = 1000;

  /// Throws Error{unsupported} that names the formats offered where none can be used.
  EyeImages(Headset& headset, const Device& device, const Session& session, const LogCallback& log);
  EyeImages(const EyeImages&) = delete;
  EyeImages& operator=(const EyeImages&) = delete;

  VkExtent2D extent() const noexcept { return extent_; }
  /// Of pictures that are drawn.
  VkFormat format() const noexcept { return drawn_ ? drawn_->info().format : colour_[0].format(); }
  VkFormat depthFormat() const noexcept { return depth_.empty() ? VK_FORMAT_D32_SFLOAT : depth_[0].format(); }
  std::string description() const;  // of all that was chosen, for people

  /// Takes the next images. Targets by eye, their depth included; drawing leaves them as their `after` says.
  std::array<Target, 2> acquire(double unitsPerMetre);
  /// Gives them back, after `finish` was recorded and the commands were submitted.
  void release();
  /// Records what brings the pictures to the runtime, where they were not drawn into its images.
  void finish(VkCommandBuffer commands) const;

  /// An eye's picture as drawn, in Target::after, while it is acquired.
  struct Picture {
    VkImage image;
    std::uint32_t layer;
  };
  Picture picture(std::uint32_t eye) const noexcept;

  XrSwapchainSubImage colour(std::uint32_t eye) const noexcept;
  /// nullopt where the runtime takes none.
  std::optional<XrSwapchainSubImage> depth(std::uint32_t eye) const noexcept;

 private:
  struct Format {
    VkFormat drawn, shown;
  };
  Format colourFormat(const std::vector<std::int64_t>& offered) const;
  std::vector<XrImages> make(VkFormat format, XrSwapchainUsageFlags usage) const;
  XrSwapchainSubImage part(const std::vector<XrImages>& images, std::uint32_t eye) const noexcept;

  Headset& headset_;
  const Device& device_;
  const Session& session_;
  VkExtent2D extent_;
  std::vector<XrImages> colour_, depth_;  // one for both eyes, or one for each; depth: or none
  std::optional<GpuImage> drawn_;         // where the runtime's images cannot be drawn into
  std::array<ImageViewHandle, 2> drawnViews_;
  std::optional<GpuImage> ownDepth_;  // where it takes no depth
  std::array<ImageViewHandle, 2> ownDepthViews_;
};

}  // namespace ibr::app
