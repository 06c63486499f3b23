// SPDX-License-Identifier: Apache-2.0
#include "ibr/offscreen.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "base/check.h"
#include "base/vulkan/barrier.h"
#include "base/vulkan/buffer.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/gpu_image.h"
#include "base/vulkan/submit.h"
#include "base/vulkan/target_format.h"
#include "image/half_float.h"

namespace ibr {
namespace {

bool blueFirst(VkFormat format) {
  return format == VK_FORMAT_B8G8R8A8_UNORM || format == VK_FORMAT_B8G8R8A8_SRGB;
}

GpuImageInfo imageInfo(VkExtent2D extent, TargetFormat format) {
  check(extent.width > 0 && extent.height > 0, ErrorCode::invalidInput, "offscreen image: extent {}×{} is empty",
        extent.width, extent.height);
  checkTargetFormat("offscreen image", format);
  return {
      .format = format.format,
      .extent = extent,
      .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT};
}

// Returns the image's values of type T, by texel.
template <class T>
std::span<const T> valuesIn(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
}

}  // namespace

struct Offscreen::State {
  State(const Device& device, VkExtent2D extent, TargetFormat made)
      : format(made),
        image(device, imageInfo(extent, made), "offscreen image"),
        host(device, VkDeviceSize(extent.width) * extent.height * blockBytes(made.format),
             VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryKind::readback, "offscreen readback"),
        submission(device) {}

  // Renders and returns the texels as stored.
  std::span<const std::byte> texels(const std::function<void(VkCommandBuffer)>& record) {
    const VkExtent2D extent = image.info().extent;
    submission.run([&](VkCommandBuffer commands) {
      record(commands);
      const VkBufferImageCopy region{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                     .imageExtent = {extent.width, extent.height, 1}};
      vkCmdCopyImageToBuffer(commands, image.get(), use::kTransferSource.layout, host.get(), 1, &region);
      bufferBarrier(commands, use::kTransferWrite, use::kHostRead);
    });
    return host.mapped();
  }
  template <class T>
  Image<T> blank() const {
    return {int(image.info().extent.width), int(image.info().extent.height), 4};
  }

  TargetFormat format;
  GpuImage image;
  Buffer host;
  Submission submission;
};

Offscreen::Offscreen(const Device& device, VkExtent2D extent, TargetFormat format)
    : state_(std::make_unique<State>(device, extent, format)) {}
Offscreen::Offscreen(Offscreen&&) noexcept = default;
Offscreen& Offscreen::operator=(Offscreen&&) noexcept = default;
Offscreen::~Offscreen() = default;

Target Offscreen::target() const noexcept {
  const GpuImage& image = state_->image;
  const TargetFormat format = state_->format;
  return {.image = image.get(),
          .view = image.view(),
          .format = format.format,
          .encoding = format.encoding,
          .extent = image.info().extent,
          .finalUse = use::kTransferSource};
}

Image8 Offscreen::render(const std::function<void(VkCommandBuffer)>& record) {
  const VkFormat format = state_->format.format;
  check(isRgba8Format(format), ErrorCode::unsupported, "offscreen image: VkFormat {} needs renderFloat()", int(format));
  Image8 picture = state_->blank<std::uint8_t>();
  const std::span<const std::byte> bytes = state_->texels(record);
  std::memcpy(picture.values.data(), bytes.data(), bytes.size());
  if (blueFirst(format))
    for (std::size_t i = 0; i < picture.values.size(); i += 4) std::swap(picture.values[i], picture.values[i + 2]);
  return picture;
}

ImageF Offscreen::renderFloat(const std::function<void(VkCommandBuffer)>& record) {
  const VkFormat format = state_->format.format;
  ImageF picture = state_->blank<float>();
  if (isRgba8Format(format)) {
    std::ranges::transform(render(record).values, picture.values.begin(), [](int level) { return float(level) / 255; });
  } else if (format == VK_FORMAT_R16G16B16A16_SFLOAT) {
    std::ranges::transform(valuesIn<std::uint16_t>(state_->texels(record)), picture.values.begin(), fromHalf);
  } else {
    std::size_t i = 0;
    for (const std::uint32_t texel : valuesIn<std::uint32_t>(state_->texels(record))) {
      for (int shift = 0; shift < 30; shift += 10) picture.values[i++] = float(texel >> shift & 1023) / 1023;
      picture.values[i++] = float(texel >> 30) / 3;
    }
  }
  return picture;
}

}  // namespace ibr
