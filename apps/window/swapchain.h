// SPDX-License-Identifier: Apache-2.0
// A window's swapchain and its frames in flight.
//
// A frame is drawn into an intermediate image of display-encoded values, which is copied bit by bit into the window's
// image at the end. Frames therefore look the same in every surface format, sRGB formats included. Images are created
// again when the window changes its size or the surface reports them as out of date. A lost surface is created again,
// too. A minimised window has no pixels, and `begin` returns nothing. A frame's resources stay in use until the device
// has finished the frame. `begin` waits for the frame before the last, or returns nothing until then, depending on the
// pace.
#pragma once

#include <vulkan/vulkan_core.h>

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/vulkan/frame_slot.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/gpu_image.h"
#include "base/vulkan/handle.h"
#include "ibr/device.h"
#include "ibr/target.h"
#include "window/window.h"

namespace ibr::app {

using SemaphoreHandle = Handle<VkSemaphore, &vkDestroySemaphore>;

inline constexpr std::uint32_t kFramesInFlight = 2;

/// Owns a VkSurfaceKHR.
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

/// Synchronisation of frames with the display.
enum class Pace {
  refresh,    // waits for the display: every frame is shown, without tearing
  immediate,  // never waits: frames that come too early are dropped, so the window never delays other rendering
};

struct SwapchainOptions {
  Pace pace = Pace::refresh;
  bool onlySrgb = false;  // accepts sRGB surface formats only, for tests
};

class Swapchain {
 public:
  /// The device must have VK_KHR_swapchain and be created with Window::instanceExtensions. Throws Error{unsupported} if
  /// the device cannot present to this window.
  Swapchain(const Device& device, const Window& window, const SwapchainOptions& options = {});
  Swapchain(const Swapchain&) = delete;
  Swapchain& operator=(const Swapchain&) = delete;
  ~Swapchain();  // waits for the device

  struct Frame {
    VkCommandBuffer commands;  // recording has begun
    VkImage image;             // contents undefined; usable by transfers and as colour attachment
    VkImageView view;
    std::uint32_t slot;  // 0 to kFramesInFlight − 1; the slot's previous frame has finished
    VkExtent2D extent;
  };
  /// Use of the image as returned by `begin`, and as `end` expects the image.
  static constexpr ImageUse kInitialUse{VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_NONE};
  static constexpr ImageUse kFinalUse = use::kTransferSource;

  /// Returns nullopt if no frame can be drawn yet. Waits for the device, at any pace, when images are created again;
  /// Pace::immediate delays that until the window has kept its size for some calls. Throws Error: outOfMemory;
  /// deviceLost, also if the surface cannot be replaced or is lost more than three times in a row.
  std::optional<Frame> begin();
  /// Submits and presents the frame. Returns false if the frame is not shown: the window has changed or is hidden, or
  /// has no free image (Pace::immediate).
  bool end(const Frame& frame);
  /// Ends the commands without submitting them.
  void abandon(const Frame& frame) noexcept;

  VkFormat format() const noexcept { return format_.drawn; }  // of Frame::image; UNORM
  /// Increases when the image is replaced. The device is idle then; framebuffers of the old image are invalid.
  std::uint64_t generation() const noexcept { return generation_; }

  /// Simulates a lost surface, or no free image, at the next `end`; for tests.
  void simulateLostSurface() noexcept { simulatedResult_ = VK_ERROR_SURFACE_LOST_KHR; }
  void simulateNoImage() noexcept { simulatedResult_ = VK_NOT_READY; }

 private:
  struct Format {
    VkFormat drawn;            // of the intermediate image
    VkSurfaceFormatKHR shown;  // of the window's images
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
  bool sizeIsStable(VkExtent2D wanted) noexcept;
  bool handleSurfaceResult(VkResult result, const char* call);
  std::optional<std::uint32_t> acquire(const Slot& slot);
  void recordCopy(VkCommandBuffer commands, VkImage image) const;
  void submit(const Slot& slot, std::optional<std::uint32_t> index) const;

  const Device& device_;
  const Window& window_;
  const SwapchainOptions options_;
  std::optional<Surface> surface_;
  Format format_{};
  VkSwapchainKHR swapchain_ = VK_NULL_HANDLE;
  VkExtent2D createdFor_{0, 0};  // window size when the images were created
  VkExtent2D wanted_{0, 0};      // window size at the last call of `begin`
  int stableCalls_ = 0;          // calls of `begin` since the window size changed
  VkExtent2D extent_{0, 0};      // of the images
  std::vector<VkImage> images_;
  std::vector<SemaphoreHandle> rendered_;  // by image
  GpuImage drawn_;
  std::array<Slot, kFramesInFlight> slots_;
  std::uint32_t slot_ = 0;
  std::uint64_t generation_ = 0;
  VkResult simulatedResult_ = VK_SUCCESS;  // simulated result of the next acquisition, for tests; VK_SUCCESS: none
  bool outdated_ = true, lost_ = false;
  int losses_ = 0;  // of the surface, since the last shown frame
};

}  // namespace ibr::app
