// SPDX-License-Identifier: Apache-2.0
#include "vr/headset/eye_images.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/check.h"
#include "base/vulkan/barrier.h"
#include "base/vulkan/format.h"
#include "base/vulkan/functions.h"

namespace ibr::app {
namespace {

constexpr XrSwapchainUsageFlags kDrawn = XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT | XR_SWAPCHAIN_USAGE_TRANSFER_SRC_BIT;
constexpr XrSwapchainUsageFlags kFilled = XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT | XR_SWAPCHAIN_USAGE_TRANSFER_DST_BIT;
constexpr XrSwapchainUsageFlags kDepth = XR_SWAPCHAIN_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;

// Contents are replaced. The runtime hands over images in attachment layouts.
constexpr ImageUse kColourInitialUse{VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
                                     VK_ACCESS_2_NONE};
constexpr ImageUse kDepthInitialUse{VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
                                    VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT};

std::vector<std::int64_t> formatsOf(const Session& session) {
  std::uint32_t count = 0;
  xr(xrEnumerateSwapchainFormats(session.get(), 0, &count, nullptr), "xrEnumerateSwapchainFormats");
  std::vector<std::int64_t> formats(count);
  xr(xrEnumerateSwapchainFormats(session.get(), count, &count, formats.data()), "xrEnumerateSwapchainFormats");
  return formats;
}

bool has(const std::vector<std::int64_t>& formats, VkFormat format) {
  return std::ranges::find(formats, std::int64_t(format)) != formats.end();
}

ImageViewHandle viewOf(const Device& device, VkImage image, VkFormat format, std::uint32_t layer) {
  const bool isDepth = format == VK_FORMAT_D32_SFLOAT || format == VK_FORMAT_D16_UNORM;
  const VkImageViewCreateInfo info{
      .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
      .image = image,
      .viewType = VK_IMAGE_VIEW_TYPE_2D,
      .format = format,
      .subresourceRange = {VkImageAspectFlags(isDepth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT), 0, 1,
                           layer, 1}};
  return make<ImageViewHandle>(device, vkCreateImageView, info, "vkCreateImageView");
}

std::optional<VkFormat> pictureFormatOf(const std::vector<std::int64_t>& offered) {
  for (const VkFormat format : {VK_FORMAT_R8G8B8A8_SRGB, VK_FORMAT_B8G8R8A8_SRGB})
    if (has(offered, format)) return format;
  return std::nullopt;
}

}  // namespace

std::optional<VkFormat> pictureFormat(const Session& session) {
  return pictureFormatOf(formatsOf(session));
}

XrImages::XrImages(Headset& headset, const Device& device, const Session& session, VkFormat format,
                   XrSwapchainUsageFlags usage, VkExtent2D extent, std::uint32_t layers)
    : format_(format) {
  const XrSwapchainCreateInfo info{.type = XR_TYPE_SWAPCHAIN_CREATE_INFO,
                                   .next = nullptr,
                                   .createFlags = 0,
                                   .usageFlags = usage,
                                   .format = format,
                                   .sampleCount = 1,
                                   .width = extent.width,
                                   .height = extent.height,
                                   .faceCount = 1,
                                   .arraySize = layers,
                                   .mipCount = 1};
  const std::lock_guard lock(headset.queueMutex());
  swapchain_ = xrMake<XrSwapchainOwner>(xrCreateSwapchain, session.get(), info, "xrCreateSwapchain");
  std::uint32_t count = 0;
  xr(xrEnumerateSwapchainImages(get(), 0, &count, nullptr), "xrEnumerateSwapchainImages");
  std::vector<XrSwapchainImageVulkan2KHR> images(count, {.type = XR_TYPE_SWAPCHAIN_IMAGE_VULKAN2_KHR});
  xr(xrEnumerateSwapchainImages(get(), count, &count, reinterpret_cast<XrSwapchainImageBaseHeader*>(images.data())),
     "xrEnumerateSwapchainImages");
  for (const XrSwapchainImageVulkan2KHR& image : images) {
    Image& ours = images_.emplace_back(Image{image.image, {}});
    for (std::uint32_t layer = 0; layer < layers; ++layer)
      ours.views.push_back(viewOf(device, image.image, format, layer));
  }
}

void XrImages::acquire(Headset& headset) {
  const XrSwapchainImageAcquireInfo acquireInfo{.type = XR_TYPE_SWAPCHAIN_IMAGE_ACQUIRE_INFO, .next = nullptr};
  {
    const std::lock_guard lock(headset.queueMutex());
    xr(xrAcquireSwapchainImage(get(), &acquireInfo, &current_), "xrAcquireSwapchainImage");
  }
  const XrSwapchainImageWaitInfo waitInfo{
      .type = XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO, .next = nullptr, .timeout = XR_INFINITE_DURATION};
  xr(xrWaitSwapchainImage(get(), &waitInfo), "xrWaitSwapchainImage");
}

void XrImages::release(Headset& headset) {
  const XrSwapchainImageReleaseInfo info{.type = XR_TYPE_SWAPCHAIN_IMAGE_RELEASE_INFO, .next = nullptr};
  const std::lock_guard lock(headset.queueMutex());
  xr(xrReleaseSwapchainImage(get(), &info), "xrReleaseSwapchainImage");
}

EyeImages::EyeImages(Headset& headset, const Device& device, const Session& session, const LogCallback& log)
    : headset_(headset), device_(device), session_(session), extent_(session.eyeExtent()) {
  const std::vector<std::int64_t> offered = formatsOf(session);
  const Format colour = colourFormat(offered);
  colour_ = make(colour.shown, colour.shown == colour.drawn ? kDrawn : kFilled);
  if (colour.shown != colour.drawn) {
    drawn_ = GpuImage(device,
                      {.format = colour.drawn,
                       .extent = extent_,
                       .layers = 2,
                       .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
                       .viewType = VK_IMAGE_VIEW_TYPE_2D_ARRAY},
                      "the eyes' images");
    for (std::uint32_t eye = 0; eye < 2; ++eye) drawnViews_[eye] = makeLayerView(device, *drawn_, eye);
  }
  if (headset.supportsDepthLayer())
    for (const VkFormat format : {VK_FORMAT_D32_SFLOAT, VK_FORMAT_D16_UNORM})
      if (depth_.empty() && has(offered, format)) depth_ = make(format, kDepth);
  if (depth_.empty()) {
    ownDepth_ = GpuImage(device,
                         {.format = VK_FORMAT_D32_SFLOAT,
                          .extent = extent_,
                          .layers = 2,
                          .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT,
                          .aspect = VK_IMAGE_ASPECT_DEPTH_BIT,
                          .viewType = VK_IMAGE_VIEW_TYPE_2D_ARRAY},
                         "the eyes' depth");
    for (std::uint32_t eye = 0; eye < 2; ++eye) ownDepthViews_[eye] = makeLayerView(device, *ownDepth_, eye);
  }
  if (log) log(LogLevel::info, description());
}

EyeImages::Format EyeImages::colourFormat(const std::vector<std::int64_t>& offered) const {
  if (const auto format = pictureFormatOf(offered)) return {*format, *format};
  for (const VkFormat format :
       {VK_FORMAT_R16G16B16A16_SFLOAT, VK_FORMAT_R16G16B16A16_UNORM, VK_FORMAT_A2B10G10R10_UNORM_PACK32,
        VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_B8G8R8A8_UNORM}) {
    VkFormatProperties can{};
    vkGetPhysicalDeviceFormatProperties(device_.physicalDevice(), format, &can);
    if (has(offered, format) && can.optimalTilingFeatures & VK_FORMAT_FEATURE_BLIT_DST_BIT)
      return {VK_FORMAT_R8G8B8A8_SRGB, format};
  }
  fail(ErrorCode::unsupported, "{} offers no supported swapchain format; it offers VkFormat {}", headset_.name(),
       fmt::join(offered, ", "));
}

std::vector<XrImages> EyeImages::make(VkFormat format, XrSwapchainUsageFlags usage) const {
  std::vector<XrImages> images;
  try {
    images.emplace_back(headset_, device_, session_, format, usage, extent_, 2);
  } catch (const Error& e) {
    if (e.code() == ErrorCode::deviceLost) throw;
    for (int eye = 0; eye < 2; ++eye) images.emplace_back(headset_, device_, session_, format, usage, extent_, 1);
  }
  return images;
}

std::string EyeImages::description() const {
  const auto layers = [](const std::vector<XrImages>& images) {
    return images.size() == 1 ? "two layers" : "two images";
  };
  return fmt::format("{}×{} per eye, {}, VkFormat {}{}, depth {}", extent_.width, extent_.height, layers(colour_),
                     int(colour_[0].format()), drawn_ ? " by a blit" : "",
                     depth_.empty() ? std::string("not submitted")
                                    : fmt::format("VkFormat {}, {}", int(depth_[0].format()), layers(depth_)));
}

std::array<Target, 2> EyeImages::acquire(double unitsPerMetre) {
  for (XrImages& images : colour_) images.acquire(headset_);
  for (XrImages& images : depth_) images.acquire(headset_);
  std::array<Target, 2> targets;
  for (std::uint32_t eye = 0; eye < 2; ++eye) {
    const auto chain = [&](const std::vector<XrImages>& all) -> const XrImages& {
      return all[all.size() == 2 ? eye : 0];
    };
    const auto layer = [&](const std::vector<XrImages>& all) { return all.size() == 2 ? 0 : eye; };
    Target& target = targets[eye];
    target.extent = extent_;
    target.format = format();
    target.initialUse = kColourInitialUse;
    target.image = drawn_ ? drawn_->get() : chain(colour_).image();
    target.view = drawn_ ? drawnViews_[eye].get() : chain(colour_).view(layer(colour_));
    target.layer = drawn_ ? eye : layer(colour_);
    const bool own = depth_.empty();
    target.depth = DepthTarget{.image = own ? ownDepth_->get() : chain(depth_).image(),
                               .view = own ? ownDepthViews_[eye].get() : chain(depth_).view(layer(depth_)),
                               .format = own ? VK_FORMAT_D32_SFLOAT : depth_[0].format(),
                               .initialUse = kDepthInitialUse,
                               .nearPlane = kNearPlane * unitsPerMetre,
                               .farPlane = kFarPlane * unitsPerMetre,
                               .layer = own ? eye : layer(depth_)};
  }
  return targets;
}

void EyeImages::finish(VkCommandBuffer commands) const {
  if (!drawn_) return;
  const VkOffset3D corner{std::int32_t(extent_.width), std::int32_t(extent_.height), 1};
  transition(commands, drawn_->get(), use::kColourAttachment, use::kTransferSource);
  for (const XrImages& images : colour_)
    transition(commands, images.image(), kColourInitialUse, use::kTransferDestination);
  for (std::uint32_t eye = 0; eye < 2; ++eye) {
    const XrImages& to = colour_[colour_.size() == 2 ? eye : 0];
    const VkImageBlit region{{VK_IMAGE_ASPECT_COLOR_BIT, 0, eye, 1},
                             {{0, 0, 0}, corner},
                             {VK_IMAGE_ASPECT_COLOR_BIT, 0, colour_.size() == 2 ? 0 : eye, 1},
                             {{0, 0, 0}, corner}};
    vkCmdBlitImage(commands, drawn_->get(), use::kTransferSource.layout, to.image(), use::kTransferDestination.layout,
                   1, &region, VK_FILTER_NEAREST);
  }
  for (const XrImages& images : colour_)
    transition(commands, images.image(), use::kTransferDestination, use::kColourAttachment);
  transition(commands, drawn_->get(), use::kTransferSource, use::kColourAttachment);
}

void EyeImages::release() {
  for (XrImages& images : colour_) images.release(headset_);
  for (XrImages& images : depth_) images.release(headset_);
}

EyeImages::Picture EyeImages::picture(std::uint32_t eye) const noexcept {
  if (drawn_) return {drawn_->get(), eye};
  return {colour_[colour_.size() == 2 ? eye : 0].image(), colour_.size() == 2 ? 0 : eye};
}

XrSwapchainSubImage EyeImages::part(const std::vector<XrImages>& images, std::uint32_t eye) const noexcept {
  return {images[images.size() == 2 ? eye : 0].get(),
          {{0, 0}, {std::int32_t(extent_.width), std::int32_t(extent_.height)}},
          images.size() == 2 ? 0 : eye};
}

XrSwapchainSubImage EyeImages::colour(std::uint32_t eye) const noexcept {
  return part(colour_, eye);
}

std::optional<XrSwapchainSubImage> EyeImages::depth(std::uint32_t eye) const noexcept {
  if (depth_.empty()) return std::nullopt;
  return part(depth_, eye);
}

}  // namespace ibr::app
