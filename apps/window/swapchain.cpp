// SPDX-License-Identifier: Apache-2.0
#include "window/swapchain.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/check.h"
#include "base/vulkan/barrier.h"
#include "base/vulkan/submit.h"
#include "ibr/error.h"
#include "window/raw_copy.h"

namespace ibr::app {
namespace {

constexpr int kMaxLosses = 3;                      // consecutive losses of the surface
constexpr std::uint64_t kMaxWaitNs = 500'000'000;  // ns, for an image: a hidden window may never provide one
constexpr int kStableCalls = 20;                   // calls of `begin`
constexpr auto kForever = std::numeric_limits<std::uint64_t>::max();

// Surface formats, best first.
constexpr std::array kFormats{VK_FORMAT_B8G8R8A8_UNORM,
                              VK_FORMAT_R8G8B8A8_UNORM,
                              VK_FORMAT_A8B8G8R8_UNORM_PACK32,
                              VK_FORMAT_B8G8R8A8_SRGB,
                              VK_FORMAT_R8G8B8A8_SRGB,
                              VK_FORMAT_A8B8G8R8_SRGB_PACK32,
                              VK_FORMAT_A2B10G10R10_UNORM_PACK32,
                              VK_FORMAT_A2R10G10B10_UNORM_PACK32,
                              VK_FORMAT_R5G6B5_UNORM_PACK16};

std::vector<VkSurfaceFormatKHR> surfaceFormats(VkPhysicalDevice device, VkSurfaceKHR surface) {
  std::uint32_t count = 0;
  vk(vkGetPhysicalDeviceSurfaceFormatsKHR(device, surface, &count, nullptr), "vkGetPhysicalDeviceSurfaceFormatsKHR");
  std::vector<VkSurfaceFormatKHR> formats(count);
  vk(vkGetPhysicalDeviceSurfaceFormatsKHR(device, surface, &count, formats.data()),
     "vkGetPhysicalDeviceSurfaceFormatsKHR");
  return formats;
}

std::vector<VkPresentModeKHR> presentModes(VkPhysicalDevice device, VkSurfaceKHR surface) {
  std::uint32_t count = 0;
  vk(vkGetPhysicalDeviceSurfacePresentModesKHR(device, surface, &count, nullptr),
     "vkGetPhysicalDeviceSurfacePresentModesKHR");
  std::vector<VkPresentModeKHR> modes(count);
  vk(vkGetPhysicalDeviceSurfacePresentModesKHR(device, surface, &count, modes.data()),
     "vkGetPhysicalDeviceSurfacePresentModesKHR");
  return modes;
}

bool isSrgb(VkFormat format) {
  return format == VK_FORMAT_B8G8R8A8_SRGB || format == VK_FORMAT_R8G8B8A8_SRGB ||
         format == VK_FORMAT_A8B8G8R8_SRGB_PACK32;
}

bool same(VkExtent2D a, VkExtent2D b) {
  return a.width == b.width && a.height == b.height;
}

SemaphoreHandle makeSemaphore(const Device& device) {
  return make<SemaphoreHandle>(device, vkCreateSemaphore,
                               VkSemaphoreCreateInfo{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO},
                               "vkCreateSemaphore");
}

// Prefers opaque: the picture's alpha has no meaning for the desktop behind the window.
VkCompositeAlphaFlagBitsKHR compositeAlpha(VkCompositeAlphaFlagsKHR can) {
  for (const auto wanted : {VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR, VK_COMPOSITE_ALPHA_INHERIT_BIT_KHR,
                            VK_COMPOSITE_ALPHA_POST_MULTIPLIED_BIT_KHR})
    if (can & wanted) return wanted;
  return VK_COMPOSITE_ALPHA_PRE_MULTIPLIED_BIT_KHR;
}

VkExtent2D extentOf(const VkSurfaceCapabilitiesKHR& can, VkExtent2D window) {
  const bool free = can.currentExtent.width == std::numeric_limits<std::uint32_t>::max();
  const VkExtent2D wanted = free ? window : can.currentExtent;
  return {std::clamp(wanted.width, can.minImageExtent.width, can.maxImageExtent.width),
          std::clamp(wanted.height, can.minImageExtent.height, can.maxImageExtent.height)};
}

}  // namespace

Swapchain::Swapchain(const Device& device, const Window& window, const SwapchainOptions& options)
    : device_(device), window_(window), options_(options) {
  makeSurface();
  for (Slot& slot : slots_) {
    static_cast<FrameSlot&>(slot) = makeFrameSlot(device_);
    slot.acquired = makeSemaphore(device_);
  }
}

Swapchain::~Swapchain() {
  waitIdle(device_);
  drop();
}

// Prefers the sRGB colour space, but takes any other rather than fail.
Swapchain::Format Swapchain::chosenFormat() const {
  const std::vector<VkSurfaceFormatKHR> formats = surfaceFormats(device_.physicalDevice(), surface_->get());
  for (const bool anySpace : {false, true})
    for (const VkFormat shown : kFormats)
      for (const VkSurfaceFormatKHR& format : formats)
        if (format.format == shown && (anySpace || format.colorSpace == VK_COLOR_SPACE_SRGB_NONLINEAR_KHR) &&
            (!options_.onlySrgb || isSrgb(shown)))
          return {rawFormat(shown), format};
  fail(ErrorCode::unsupported, "none of the window's {} surface formats is supported", formats.size());
}

// FIFO is the only mode that every surface supports.
VkPresentModeKHR Swapchain::chosenMode() const {
  if (options_.pace == Pace::refresh) return VK_PRESENT_MODE_FIFO_KHR;
  const std::vector<VkPresentModeKHR> modes = presentModes(device_.physicalDevice(), surface_->get());
  for (const auto wanted : {VK_PRESENT_MODE_MAILBOX_KHR, VK_PRESENT_MODE_IMMEDIATE_KHR})
    if (std::ranges::find(modes, wanted) != modes.end()) return wanted;
  return VK_PRESENT_MODE_FIFO_KHR;
}

void Swapchain::makeSurface() {
  vk(waitIdle(device_), "vkDeviceWaitIdle");
  drop();
  surface_.reset();  // first: a window can have only one surface
  surface_.emplace(device_.instance(), window_);
  VkBool32 shows = VK_FALSE;
  vk(vkGetPhysicalDeviceSurfaceSupportKHR(device_.physicalDevice(), device_.queueFamily(), surface_->get(), &shows),
     "vkGetPhysicalDeviceSurfaceSupportKHR");
  check(shows, ErrorCode::unsupported, "{} cannot present to this window", device_.name());
  format_ = chosenFormat();
  lost_ = false;
}

// Creates the surface again. Reports a lost device if the new surface fails or has another format.
void Swapchain::replaceSurface() try {
  const VkFormat before = format_.drawn;
  makeSurface();
  check(before == format_.drawn, ErrorCode::deviceLost, "the window's surface format has changed");
} catch (const Error& e) {
  fail(ErrorCode::deviceLost, "the window's surface was lost: {}", e.what());
}

void Swapchain::drop() noexcept {
  rendered_.clear();
  images_.clear();
  vkDestroySwapchainKHR(device_.handle(), std::exchange(swapchain_, VK_NULL_HANDLE), nullptr);
}

// Returns true if `call` succeeded. Lost surfaces and outdated images are replaced by the next frame.
bool Swapchain::handleSurfaceResult(VkResult result, const char* call) {
  if (result == VK_ERROR_SURFACE_LOST_KHR) {
    check(++losses_ <= kMaxLosses, ErrorCode::deviceLost, "{}: the window's surface was lost repeatedly", call);
    lost_ = true;
  }
  outdated_ |= lost_ || result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_SUBOPTIMAL_KHR;
  if (lost_ || result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_TIMEOUT || result == VK_NOT_READY) return false;
  if (result != VK_SUBOPTIMAL_KHR) vk(result, call);
  return true;
}

void Swapchain::makeImages() {
  vk(waitIdle(device_), "vkDeviceWaitIdle");
  drop();
  VkSurfaceCapabilitiesKHR can{};
  if (!handleSurfaceResult(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device_.physicalDevice(), surface_->get(), &can),
                           "vkGetPhysicalDeviceSurfaceCapabilitiesKHR"))
    return;
  createdFor_ = window_.pixels();
  extent_ = extentOf(can, createdFor_);
  if (extent_.width == 0 || extent_.height == 0) return;
  check(can.supportedUsageFlags & VK_IMAGE_USAGE_TRANSFER_DST_BIT, ErrorCode::unsupported,
        "{} cannot copy images to this window", device_.name());
  const std::uint32_t most = can.maxImageCount > 0 ? can.maxImageCount : std::numeric_limits<std::uint32_t>::max();
  const VkSwapchainCreateInfoKHR info{.sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR,
                                      .surface = surface_->get(),
                                      .minImageCount = std::min(can.minImageCount + 1, most),
                                      .imageFormat = format_.shown.format,
                                      .imageColorSpace = format_.shown.colorSpace,
                                      .imageExtent = extent_,
                                      .imageArrayLayers = 1,
                                      .imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT,
                                      .imageSharingMode = VK_SHARING_MODE_EXCLUSIVE,
                                      .preTransform = can.currentTransform,
                                      .compositeAlpha = compositeAlpha(can.supportedCompositeAlpha),
                                      .presentMode = chosenMode(),
                                      .clipped = VK_TRUE};
  if (!handleSurfaceResult(vkCreateSwapchainKHR(device_.handle(), &info, nullptr, &swapchain_), "vkCreateSwapchainKHR"))
    return;
  std::uint32_t count = 0;
  vk(vkGetSwapchainImagesKHR(device_.handle(), swapchain_, &count, nullptr), "vkGetSwapchainImagesKHR");
  std::vector<VkImage> images(count);
  vk(vkGetSwapchainImagesKHR(device_.handle(), swapchain_, &count, images.data()), "vkGetSwapchainImagesKHR");
  while (rendered_.size() < images.size()) rendered_.push_back(makeSemaphore(device_));
  ++generation_;
  drawn_ = {};  // release first, so that two images are never allocated at once
  drawn_ = GpuImage(device_,
                    {.format = format_.drawn,
                     .extent = extent_,
                     .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                              VK_IMAGE_USAGE_TRANSFER_DST_BIT},
                    "the window's image");
  images_ = std::move(images);
  outdated_ = false;
}

bool Swapchain::sizeIsStable(VkExtent2D wanted) noexcept {
  stableCalls_ = same(wanted, wanted_) ? stableCalls_ + 1 : 0;
  wanted_ = wanted;
  return stableCalls_ >= kStableCalls;
}

std::optional<Swapchain::Frame> Swapchain::begin() {
  const VkExtent2D wanted = window_.pixels();
  if (wanted.width == 0 || wanted.height == 0) return std::nullopt;
  if (lost_) replaceSurface();
  const bool stale = outdated_ || !same(wanted, createdFor_), rested = sizeIsStable(wanted);
  // Creating images waits for the device. With Pace::immediate, wait for the window to keep its size for some calls.
  if (stale && !rested && options_.pace == Pace::immediate && generation_ > 0) return std::nullopt;
  if (stale) makeImages();
  if (images_.empty()) return std::nullopt;
  const Slot& slot = slots_[slot_];
  const VkFence done = slot.done.get();
  const VkResult waited =
      vkWaitForFences(device_.handle(), 1, &done, VK_TRUE, options_.pace == Pace::immediate ? 0 : kForever);
  if (waited == VK_TIMEOUT) return std::nullopt;
  vk(device_, waited, "vkWaitForFences");
  beginCommands(device_, slot);
  return Frame{slot.commands, drawn_.get(), drawn_.view(), slot_, extent_};
}

std::optional<std::uint32_t> Swapchain::acquire(const Slot& slot) {
  std::uint32_t index = 0;
  const std::uint64_t longest = options_.pace == Pace::immediate ? 0 : kMaxWaitNs;
  VkResult result = std::exchange(simulatedResult_, VK_SUCCESS);
  if (result == VK_SUCCESS)
    result = vkAcquireNextImageKHR(device_.handle(), swapchain_, longest, slot.acquired.get(), VK_NULL_HANDLE, &index);
  return handleSurfaceResult(result, "vkAcquireNextImageKHR") ? std::optional(index) : std::nullopt;
}

void Swapchain::recordCopy(VkCommandBuffer commands, VkImage image) const {
  constexpr ImageUse kAcquired{VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_NONE};
  // Presentation waits for a semaphore signalled after all commands, so the last layout change must be among them.
  constexpr ImageUse kShown{VK_IMAGE_LAYOUT_PRESENT_SRC_KHR, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_NONE};
  transition(commands, image, kAcquired, use::kTransferDestination);
  recordRawCopy(commands, {drawn_.get()}, {image}, extent_);
  transition(commands, image, use::kTransferDestination, kShown);
}

void Swapchain::submit(const Slot& slot, std::optional<std::uint32_t> index) const {
  const VkFence done = slot.done.get();
  vk(vkResetFences(device_.handle(), 1, &done), "vkResetFences");
  // Only the copy at the end needs the window's image.
  const auto semaphore = [](VkSemaphore which) {
    return VkSemaphoreSubmitInfo{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                                 .semaphore = which,
                                 .stageMask = VK_PIPELINE_STAGE_2_TRANSFER_BIT};
  };
  const VkSemaphoreSubmitInfo wait = semaphore(slot.acquired.get());
  VkSemaphoreSubmitInfo signal = semaphore(index ? rendered_[*index].get() : VK_NULL_HANDLE);
  signal.stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  const VkCommandBufferSubmitInfo commands{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                           .commandBuffer = slot.commands};
  const VkSubmitInfo2 submission{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
                                 .waitSemaphoreInfoCount = index ? 1u : 0u,
                                 .pWaitSemaphoreInfos = &wait,
                                 .commandBufferInfoCount = 1,
                                 .pCommandBufferInfos = &commands,
                                 .signalSemaphoreInfoCount = index ? 1u : 0u,
                                 .pSignalSemaphoreInfos = &signal};
  const QueueLock lock(device_);
  vk(device_, vkQueueSubmit2(device_.queue(), 1, &submission, done), "vkQueueSubmit2");
}

bool Swapchain::end(const Frame& frame) {
  const Slot& slot = slots_[frame.slot];
  // Submit the commands even without a window image: the streamer counts recorded uploads as resident.
  const std::optional<std::uint32_t> index = acquire(slot);
  if (index) recordCopy(frame.commands, images_[*index]);
  vk(vkEndCommandBuffer(frame.commands), "vkEndCommandBuffer");
  submit(slot, index);
  slot_ = (slot_ + 1) % kFramesInFlight;
  if (!index) return false;
  const VkSemaphore rendered = rendered_[*index].get();
  const VkPresentInfoKHR present{.sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR,
                                 .waitSemaphoreCount = 1,
                                 .pWaitSemaphores = &rendered,
                                 .swapchainCount = 1,
                                 .pSwapchains = &swapchain_,
                                 .pImageIndices = &*index};
  const QueueLock lock(device_);
  if (!handleSurfaceResult(vkQueuePresentKHR(device_.queue(), &present), "vkQueuePresentKHR")) return false;
  losses_ = 0;
  return true;
}

void Swapchain::abandon(const Frame& frame) noexcept {
  vkEndCommandBuffer(frame.commands);
}

}  // namespace ibr::app
