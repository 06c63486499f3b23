// SPDX-License-Identifier: Apache-2.0
#include "viewer/swapchain.h"

#include <algorithm>
#include <limits>

#include "base/check.h"

namespace ibr::app {
namespace {

constexpr VkImageUsageFlags kUsage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;

// Values are display-encoded by us; a surface that only takes linear ones encodes them again when they are blitted.
VkSurfaceFormatKHR chosenFormat(VkPhysicalDevice device, VkSurfaceKHR surface) {
  std::uint32_t count = 0;
  vk(vkGetPhysicalDeviceSurfaceFormatsKHR(device, surface, &count, nullptr), "vkGetPhysicalDeviceSurfaceFormatsKHR");
  std::vector<VkSurfaceFormatKHR> formats(count);
  vk(vkGetPhysicalDeviceSurfaceFormatsKHR(device, surface, &count, formats.data()),
     "vkGetPhysicalDeviceSurfaceFormatsKHR");
  for (const VkFormat wanted : {VK_FORMAT_B8G8R8A8_UNORM, VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_A2B10G10R10_UNORM_PACK32,
                                VK_FORMAT_A2R10G10B10_UNORM_PACK32})
    for (const VkSurfaceFormatKHR& format : formats)
      if (format.format == wanted && format.colorSpace == VK_COLOR_SPACE_SRGB_NONLINEAR_KHR) return format;
  fail(ErrorCode::unsupported, "the window takes none of the {} formats that pictures can be shown in", count);
}

}  // namespace

Swapchain::Swapchain(const Device& device, const Window& window)
    : device_(device), window_(window), surface_(window.makeSurface(device.instance())) {
  try {
    VkBool32 shows = VK_FALSE;
    vk(vkGetPhysicalDeviceSurfaceSupportKHR(device.physicalDevice(), device.queueFamily(), surface_, &shows),
       "vkGetPhysicalDeviceSurfaceSupportKHR");
    check(shows, ErrorCode::unsupported, "{} cannot show pictures in this window", device.name());
    format_ = chosenFormat(device.physicalDevice(), surface_);
    for (Slot& slot : slots_) {
      slot.pool = make<CommandPoolHandle>(device, vkCreateCommandPool,
                                          VkCommandPoolCreateInfo{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                                                  .queueFamilyIndex = device.queueFamily()},
                                          "vkCreateCommandPool");
      const VkCommandBufferAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                                 .commandPool = slot.pool.get(),
                                                 .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                                 .commandBufferCount = 1};
      vk(vkAllocateCommandBuffers(device.handle(), &allocate, &slot.commands), "vkAllocateCommandBuffers");
      slot.done = make<FenceHandle>(
          device, vkCreateFence,
          VkFenceCreateInfo{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO, .flags = VK_FENCE_CREATE_SIGNALED_BIT},
          "vkCreateFence");
      slot.acquired = make<SemaphoreHandle>(device, vkCreateSemaphore,
                                            VkSemaphoreCreateInfo{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO},
                                            "vkCreateSemaphore");
    }
  } catch (...) {
    vkDestroySurfaceKHR(device.instance(), surface_, nullptr);
    throw;
  }
}

Swapchain::~Swapchain() {
  vkDeviceWaitIdle(device_.handle());
  drop();
  vkDestroySurfaceKHR(device_.instance(), surface_, nullptr);
}

void Swapchain::drop() noexcept {
  rendered_.clear();
  views_.clear();
  images_.clear();
  vkDestroySwapchainKHR(device_.handle(), std::exchange(swapchain_, VK_NULL_HANDLE), nullptr);
}

void Swapchain::makeImages() {
  vk(vkDeviceWaitIdle(device_.handle()), "vkDeviceWaitIdle");
  // A semaphore that an abandoned frame has left signalled cannot be waited for.
  for (Slot& slot : slots_)
    slot.acquired = make<SemaphoreHandle>(device_, vkCreateSemaphore,
                                          VkSemaphoreCreateInfo{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO},
                                          "vkCreateSemaphore");
  drop();
  ++generation_;
  VkSurfaceCapabilitiesKHR can{};
  vk(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device_.physicalDevice(), surface_, &can),
     "vkGetPhysicalDeviceSurfaceCapabilitiesKHR");
  extent_ = can.currentExtent.width != std::numeric_limits<std::uint32_t>::max() ? can.currentExtent : window_.pixels();
  extent_.width = std::clamp(extent_.width, can.minImageExtent.width, can.maxImageExtent.width);
  extent_.height = std::clamp(extent_.height, can.minImageExtent.height, can.maxImageExtent.height);
  if (extent_.width == 0 || extent_.height == 0) return;
  check((can.supportedUsageFlags & kUsage) == kUsage, ErrorCode::unsupported,
        "{} cannot copy pictures into this window", device_.name());
  const std::uint32_t most = can.maxImageCount > 0 ? can.maxImageCount : std::numeric_limits<std::uint32_t>::max();
  const VkSwapchainCreateInfoKHR info{
      .sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR,
      .surface = surface_,
      .minImageCount = std::min(std::max(can.minImageCount + 1, 2u), most),
      .imageFormat = format_.format,
      .imageColorSpace = format_.colorSpace,
      .imageExtent = extent_,
      .imageArrayLayers = 1,
      .imageUsage = kUsage,
      .imageSharingMode = VK_SHARING_MODE_EXCLUSIVE,
      .preTransform = can.currentTransform,
      .compositeAlpha = (can.supportedCompositeAlpha & VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR)
                            ? VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                            : VK_COMPOSITE_ALPHA_INHERIT_BIT_KHR,
      .presentMode = VK_PRESENT_MODE_FIFO_KHR,
      .clipped = VK_TRUE};
  vk(vkCreateSwapchainKHR(device_.handle(), &info, nullptr, &swapchain_), "vkCreateSwapchainKHR");
  std::uint32_t count = 0;
  vk(vkGetSwapchainImagesKHR(device_.handle(), swapchain_, &count, nullptr), "vkGetSwapchainImagesKHR");
  images_.resize(count);
  vk(vkGetSwapchainImagesKHR(device_.handle(), swapchain_, &count, images_.data()), "vkGetSwapchainImagesKHR");
  for (const VkImage image : images_) {
    views_.push_back(
        make<ImageViewHandle>(device_, vkCreateImageView,
                              VkImageViewCreateInfo{.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                                    .image = image,
                                                    .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                                    .format = format_.format,
                                                    .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}},
                              "vkCreateImageView"));
    rendered_.push_back(make<SemaphoreHandle>(device_, vkCreateSemaphore,
                                              VkSemaphoreCreateInfo{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO},
                                              "vkCreateSemaphore"));
  }
  outdated_ = false;
}

std::optional<Swapchain::Frame> Swapchain::begin() {
  const VkExtent2D wanted = window_.pixels();
  if (wanted.width == 0 || wanted.height == 0) return std::nullopt;
  if (outdated_ || wanted.width != extent_.width || wanted.height != extent_.height) makeImages();
  if (images_.empty()) return std::nullopt;
  Slot& slot = slots_[slot_];
  const VkFence done = slot.done.get();
  vk(vkWaitForFences(device_.handle(), 1, &done, VK_TRUE, std::numeric_limits<std::uint64_t>::max()),
     "vkWaitForFences");
  std::uint32_t index = 0;
  const VkResult result = vkAcquireNextImageKHR(device_.handle(), swapchain_, std::numeric_limits<std::uint64_t>::max(),
                                                slot.acquired.get(), VK_NULL_HANDLE, &index);
  if (result == VK_ERROR_OUT_OF_DATE_KHR) {
    outdated_ = true;
    return std::nullopt;
  }
  if (result == VK_SUBOPTIMAL_KHR)
    outdated_ = true;  // after this frame
  else
    vk(result, "vkAcquireNextImageKHR");
  vk(vkResetCommandPool(device_.handle(), slot.pool.get(), 0), "vkResetCommandPool");
  const VkCommandBufferBeginInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                      .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
  vk(vkBeginCommandBuffer(slot.commands, &info), "vkBeginCommandBuffer");
  return Frame{slot.commands, images_[index], views_[index].get(), index, slot_, extent_};
}

void Swapchain::end(const Frame& frame) {
  Slot& slot = slots_[frame.slot];
  vk(vkEndCommandBuffer(frame.commands), "vkEndCommandBuffer");
  const VkFence done = slot.done.get();
  vk(vkResetFences(device_.handle(), 1, &done), "vkResetFences");
  const auto semaphore = [](VkSemaphore which) {
    return VkSemaphoreSubmitInfo{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                                 .semaphore = which,
                                 .stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT};
  };
  const VkSemaphoreSubmitInfo wait = semaphore(slot.acquired.get()), signal = semaphore(rendered_[frame.index].get());
  const VkCommandBufferSubmitInfo commands{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                           .commandBuffer = frame.commands};
  const VkSubmitInfo2 submit{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
                             .waitSemaphoreInfoCount = 1,
                             .pWaitSemaphoreInfos = &wait,
                             .commandBufferInfoCount = 1,
                             .pCommandBufferInfos = &commands,
                             .signalSemaphoreInfoCount = 1,
                             .pSignalSemaphoreInfos = &signal};
  vk(vkQueueSubmit2(device_.queue(), 1, &submit, done), "vkQueueSubmit2");
  slot_ = (slot_ + 1) % kFramesInFlight;
  const VkSemaphore shown = signal.semaphore;
  const VkPresentInfoKHR present{.sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR,
                                 .waitSemaphoreCount = 1,
                                 .pWaitSemaphores = &shown,
                                 .swapchainCount = 1,
                                 .pSwapchains = &swapchain_,
                                 .pImageIndices = &frame.index};
  const VkResult result = vkQueuePresentKHR(device_.queue(), &present);
  if (result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_SUBOPTIMAL_KHR)
    outdated_ = true;
  else
    vk(result, "vkQueuePresentKHR");
}

void Swapchain::abandon(const Frame& frame) noexcept {
  vkEndCommandBuffer(frame.commands);
  outdated_ = true;
}

}  // namespace ibr::app
