// SPDX-License-Identifier: Apache-2.0
// A window's images, and the frames that are in flight to them.
//
// A frame is drawn into one image of our own, of display-encoded values, and copied bit by bit into the window's at the
// end. So it looks the same in every format that a window may have, those that would encode values again included, and
// what draws knows one image. Images are made anew when the window changes its size or the surface says that they are
// out of date, and the surface too where it is lost; until there is something to draw into (a minimised window has no
// pixels) `begin` gives nothing. Frames use what they use until the device has finished them: `begin` waits for the
// frame before the last, or gives nothing until it is done, as the pace says.
#pragma once

#include <vulkan/vulkan_core.h>

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "gpu/device/handle.h"
#include "gpu/transfer/frame_slot.h"
#include "gpu/transfer/gpu_image.h"
#include "ibr/device.h"
#include "ibr/target.h"
#include "window/window.h"

namespace ibr::app {

using SemaphoreHandle = Handle<VkSemaphore, vkDestroySemaphore>;

inline constexpr std::uint32_t kFramesInFlight = 2;

/// Owns it.
class Surface {
 public:
  Surface(VkInstance instance, const Window& window) : instance_(instance), surface_(window.makeSurface(instance)) {}
  Surface(const Surface&) = delete;
  Surface& operator=(const Surface&) = delete;
  ~Surface() { vkDestroySurfaceKHR(instance_, surface_, nullptr); }
  VkSurfaceKHR get() const noexcept { return surface_; }

 private:
  VkInstance instance_;
  VkSurfaceKHR surface_;
};

/// What a frame waits for.
enum class Pace {
  refresh,   // the display: each frame is shown, none is torn
  whenever,  // nothing: what comes too soon is dropped, so that a window never holds up what else a program draws
};

struct SwapchainOptions {
  Pace pace = Pace::refresh;
  bool onlySrgb = false;  // as if the window took such formats alone, for tests
};

class Swapchain {
 public:
  /// The device has VK_KHR_swapchain and was made with Window::instanceExtensions. Throws Error{unsupported} where it
  /// cannot show pictures in this window.
  Swapchain(const Device& device, const Window& window, const SwapchainOptions& options = {});
  Swapchain(const Swapchain&) = delete;
  Swapchain& operator=(const Swapchain&) = delete;
  ~Swapchain();  // waits for the device

  struct Frame {
    VkCommandBuffer commands;  // begun
    VkImage image;             // its contents are lost; transfers and colour attachments may write it
    VkImageView view;
    std::uint32_t slot;  // 0 to kFramesInFlight − 1: what was used with it before is free again
    VkExtent2D extent;
  };
  /// How the image is when `begin` gives it, and how `end` takes it.
  static constexpr ImageUse kBefore{VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_NONE};
  static constexpr ImageUse kAfter = use::kTransferSource;

  /// nullopt: not now. Waits for the device, at any pace, where the window has changed and images are made anew; where
  /// the pace is `whenever`, that is once the window has rested for some calls. Throws Error: outOfMemory; deviceLost,
  /// also where the surface is lost again and again.
  std::optional<Frame> begin();
  /// Submits and shows it. Says whether it is shown: the window may have changed or be hidden meanwhile, or have no
  /// image free where the pace is `whenever`.
  bool end(const Frame& frame);
  /// Ends the commands without submitting them.
  void abandon(const Frame& frame) noexcept;

  VkFormat format() const noexcept { return format_.drawn; }  // of Frame::image; UNORM
  /// Raised whenever the image is another one: what was made for it is of no use, and the device is idle then.
  std::uint64_t generation() const noexcept { return generation_; }

  /// As if the surface were lost, or had no image free, when the frame is to be shown; for tests.
  void loseSurface() noexcept { acquires_ = VK_ERROR_SURFACE_LOST_KHR; }
  void keepImages() noexcept { acquires_ = VK_NOT_READY; }

 private:
  struct Format {
    VkFormat drawn;            // by us
    VkSurfaceFormatKHR shown;  // by the window
  };
  struct Slot : FrameSlot {
    SemaphoreHandle acquired;
  };
  Format chosenFormat() const;
  VkPresentModeKHR chosenMode() const;
  void makeSurface();
  void replaceSurface();
  void makeImages();
  void drop() noexcept;
  bool rests(VkExtent2D wanted) noexcept;
  bool goesOn(VkResult result, const char* call);
  std::optional<std::uint32_t> acquire(const Slot& slot);
  void recordCopy(VkCommandBuffer commands, VkImage image) const;
  void submit(const Slot& slot, std::optional<std::uint32_t> index) const;

  const Device& device_;
  const Window& window_;
  const SwapchainOptions options_;
  std::optional<Surface> surface_;
  Format format_{};
  VkSwapchainKHR swapchain_ = VK_NULL_HANDLE;
  VkExtent2D madeFor_{0, 0};  // when the images were made
  VkExtent2D wanted_{0, 0};   // by the window, at the last call of `begin`
  int rested_ = 0;            // such calls since it has changed
  VkExtent2D extent_{0, 0};   // of the images
  std::vector<VkImage> images_;
  std::vector<SemaphoreHandle> rendered_;  // by image
  GpuImage drawn_;
  std::array<Slot, kFramesInFlight> slots_;
  std::uint32_t slot_ = 0;
  std::uint64_t generation_ = 0;
  VkResult acquires_ = VK_SUCCESS;  // what the next acquisition says, where it is not asked
  bool outdated_ = true, lost_ = false;
  int losses_ = 0;  // of the surface, since something was shown
};

}  // namespace ibr::app
