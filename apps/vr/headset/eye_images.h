// SPDX-License-Identifier: Apache-2.0
// The OpenXR runtime's images for both eyes, as targets of a renderer: colour, and depth for the runtime's reprojection
// if supported (XR_KHR_composition_layer_depth). One image with two layers if the runtime supports arrays, else one
// image for each eye.
//
// Runtimes decode sRGB formats and treat all other formats as linear. Frames are drawn into the runtime's sRGB images
// if there are any, else into an own sRGB image that a blit converts to linear values. Threading: one thread.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "base/vulkan/gpu_image.h"
#include "ibr/log.h"
#include "ibr/target.h"
#include "vr/headset/xr_session.h"

namespace ibr::app {

/// One of the runtime's swapchains; its images have one or two layers.
class XrImages {
 public:
  XrImages() = default;
  XrImages(Headset& headset, const Device& device, const Session& session, VkFormat format, XrSwapchainUsageFlags usage,
           VkExtent2D extent, std::uint32_t layers);

  /// Acquires the next image and waits until writing is allowed.
  void acquire(Headset& headset);
  void release(Headset& headset);

  XrSwapchain get() const noexcept { return swapchain_.get(); }
  VkImage image() const noexcept { return images_[current_].image; }  // the acquired image
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

/// Returns an 8-bit sRGB format of the runtime, for display-encoded pictures; nullopt: none.
std::optional<VkFormat> pictureFormat(const Session& session);

class EyeImages {
 public:
  /// Near and far plane of the depth for the runtime and for the guiding shapes, metres.
  static constexpr double kNearPlane = 0.05, kFarPlane = 1000;

  /// Throws Error{unsupported}, naming the offered formats, if none of them can be used.
  EyeImages(Headset& headset, const Device& device, const Session& session, const LogCallback& log);
  EyeImages(const EyeImages&) = delete;
  EyeImages& operator=(const EyeImages&) = delete;

  VkExtent2D extent() const noexcept { return extent_; }
  /// Format of the images that are drawn.
  VkFormat format() const noexcept { return drawn_ ? drawn_->info().format : colour_[0].format(); }
  VkFormat depthFormat() const noexcept { return depth_.empty() ? VK_FORMAT_D32_SFLOAT : depth_[0].format(); }
  std::string description() const;  // of all choices, for people

  /// Acquires the next images. Returns a target for each eye, depth included; drawing leaves them in Target::finalUse.
  std::array<Target, 2> acquire(double unitsPerMetre);
  /// Returns the images to the runtime. Record `finish` and submit the commands first.
  void release();
  /// Records the blit into the runtime's images; does nothing if they were drawn directly.
  void finish(VkCommandBuffer commands) const;

  /// An eye's image as drawn, in Target::finalUse. Valid while the images are acquired.
  struct Picture {
    VkImage image;
    std::uint32_t layer;
  };
  Picture picture(std::uint32_t eye) const noexcept;

  XrSwapchainSubImage colour(std::uint32_t eye) const noexcept;
  /// nullopt if the runtime takes no depth.
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
  std::vector<XrImages> colour_, depth_;  // one for both eyes, or one for each; depth_ may be empty
  std::optional<GpuImage> drawn_;         // if the runtime's images cannot be drawn into
  std::array<ImageViewHandle, 2> drawnViews_;
  std::optional<GpuImage> ownDepth_;  // if the runtime takes no depth
  std::array<ImageViewHandle, 2> ownDepthViews_;
};

}  // namespace ibr::app
