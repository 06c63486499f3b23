// SPDX-License-Identifier: Apache-2.0
#include "ibr/offscreen.h"

#include <cstring>
#include <utility>

#include "base/check.h"
#include "base/vulkan/barrier.h"
#include "base/vulkan/buffer.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/gpu_image.h"
#include "base/vulkan/submit.h"

namespace ibr {
namespace {

bool blueFirst(VkFormat format) {
  return format == VK_FORMAT_B8G8R8A8_UNORM || format == VK_FORMAT_B8G8R8A8_SRGB;
}

GpuImageInfo imageInfo(VkExtent2D extent, VkFormat format) {
  check(extent.width > 0 && extent.height > 0, ErrorCode::invalidInput, "offscreen image: extent {}×{} is empty",
        extent.width, extent.height);
  check(blueFirst(format) || format == VK_FORMAT_R8G8B8A8_UNORM || format == VK_FORMAT_R8G8B8A8_SRGB,
        ErrorCode::unsupported, "offscreen image: VkFormat {} is not 8-bit RGBA or BGRA", int(format));
  return {
      .format = format,
      .extent = extent,
      .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT};
}

}  // namespace

struct Offscreen::State {
  State(const Device& device, VkExtent2D extent, VkFormat format)
      : image(device, imageInfo(extent, format), "offscreen image"),
        host(device, VkDeviceSize(extent.width) * extent.height * 4, VK_BUFFER_USAGE_TRANSFER_DST_BIT,
             MemoryKind::readback, "offscreen readback"),
        submission(device) {}

  GpuImage image;
  Buffer host;
  Submission submission;
};

Offscreen::Offscreen(const Device& device, VkExtent2D extent, VkFormat format)
    : state_(std::make_unique<State>(device, extent, format)) {}
Offscreen::Offscreen(Offscreen&&) noexcept = default;
Offscreen& Offscreen::operator=(Offscreen&&) noexcept = default;
Offscreen::~Offscreen() = default;

Target Offscreen::target() const noexcept {
  const GpuImage& image = state_->image;
  return {image.get(), image.view(), image.info().format, image.info().extent, use::kUndefined, use::kTransferSource};
}

Image8 Offscreen::render(const std::function<void(VkCommandBuffer)>& record) {
  const VkExtent2D extent = state_->image.info().extent;
  state_->submission.run([&](VkCommandBuffer commands) {
    record(commands);
    const VkBufferImageCopy region{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                   .imageExtent = {extent.width, extent.height, 1}};
    vkCmdCopyImageToBuffer(commands, state_->image.get(), use::kTransferSource.layout, state_->host.get(), 1, &region);
    bufferBarrier(commands, use::kTransferWrite, use::kHostRead);
  });
  Image8 picture(int(extent.width), int(extent.height), 4);
  const std::span<const std::byte> bytes = state_->host.mapped();
  std::memcpy(picture.values.data(), bytes.data(), bytes.size());
  if (blueFirst(state_->image.info().format))
    for (std::size_t i = 0; i < picture.values.size(); i += 4) std::swap(picture.values[i], picture.values[i + 2]);
  return picture;
}

}  // namespace ibr
