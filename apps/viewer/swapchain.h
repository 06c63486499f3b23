// SPDX-License-Identifier: Apache-2.0
// A window's images, and the frames that are in flight to them.
//
// Images are made anew when the window changes its size or the surface says that they are out of date; until there is
// something to draw into (a minimised window has no pixels) `begin` gives nothing. Frames use what they use until the
// device has finished them: `begin` waits for the frame before the last.
#pragma once

#include <vulkan/vulkan_core.h>

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "gpu/handle.h"
#include "ibr/device.h"
#include "ibr/target.h"
#include "viewer/window.h"

namespace ibr::app {

using SemaphoreHandle = Handle<VkSemaphore, vkDestroySemaphore>;

inline constexpr std::uint32_t kFramesInFlight = 2;

class Swapchain {
 public:
  /// The device has VK_KHR_swapchain and was made with Window::instanceExtensions. Throws Error{unsupported} where it
  /// cannot show pictures in this window.
  Swapchain(const Device& device, const Window& window);
  Swapchain(const Swapchain&) = delete;
  Swapchain& operator=(const Swapchain&) = delete;
  ~Swapchain();  // waits for the device

  struct Frame {
    VkCommandBuffer commands;  // begun
    VkImage image;             // its contents are lost; transfers and colour attachments may write it
    VkImageView view;
    std::uint32_t index;  // of the image
    std::uint32_t slot;   // 0 to kFramesInFlight − 1: what was used with it before is free again
    VkExtent2D extent;
  };
  /// How the image may be when `begin` gives it: wait for kAcquired's stages.
  static constexpr ImageUse kAcquired{VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                      VK_ACCESS_2_NONE};

  /// nullopt: not now. Throws Error (deviceLost, outOfMemory).
  std::optional<Frame> begin();
  /// Submits and shows it. The image is in the layout of use::kPresent.
  void end(const Frame& frame);
  /// Ends the commands without submitting them; the image is given back by making all of them anew.
  void abandon(const Frame& frame) noexcept;

  VkFormat format() const noexcept { return format_.format; }
  std::uint32_t imageCount() const noexcept { return std::uint32_t(images_.size()); }
  /// Raised whenever images are other ones: what was made for them is of no use, and the device is idle then.
  std::uint64_t generation() const noexcept { return generation_; }

 private:
  struct Slot {
    CommandPoolHandle pool;
    VkCommandBuffer commands = VK_NULL_HANDLE;
    FenceHandle done;
    SemaphoreHandle acquired;
  };
  void makeImages();
  void drop() noexcept;

  const Device& device_;
  const Window& window_;
  VkSurfaceKHR surface_ = VK_NULL_HANDLE;
  VkSwapchainKHR swapchain_ = VK_NULL_HANDLE;
  VkSurfaceFormatKHR format_{};
  VkExtent2D extent_{0, 0};
  std::vector<VkImage> images_;
  std::vector<ImageViewHandle> views_;
  std::vector<SemaphoreHandle> rendered_;  // by image
  std::array<Slot, kFramesInFlight> slots_;
  std::uint32_t slot_ = 0;
  std::uint64_t generation_ = 0;
  bool outdated_ = true;
};

}  // namespace ibr::app
