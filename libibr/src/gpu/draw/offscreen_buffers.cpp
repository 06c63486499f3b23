// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstring>

#include "base/check.h"
#include "base/vulkan/barrier.h"
#include "base/vulkan/buffer.h"
#include "base/vulkan/format.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/gpu_image.h"
#include "base/vulkan/submit.h"
#include "ibr/offscreen.h"

namespace ibr {
namespace {

struct Plane {
  Plane(const Device& device, VkExtent2D extent, VkFormat format, const char* name)
      : image(device,
              {.format = format,
               .extent = extent,
               .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT},
              name),
        host(device, VkDeviceSize(extent.width) * extent.height * blockBytes(format), VK_BUFFER_USAGE_TRANSFER_DST_BIT,
             MemoryKind::readback, name) {}

  BufferTarget target() const { return {image.get(), image.view(), use::kUndefined, use::kTransferSource}; }
  void copy(VkCommandBuffer commands) const {
    const VkExtent2D extent = image.info().extent;
    const VkBufferImageCopy region{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                   .imageExtent = {extent.width, extent.height, 1}};
    vkCmdCopyImageToBuffer(commands, image.get(), use::kTransferSource.layout, host.get(), 1, &region);
  }
  ImageF values() {
    const VkExtent2D extent = image.info().extent;
    ImageF values(int(extent.width), int(extent.height), int(blockBytes(image.info().format) / sizeof(float)));
    std::memcpy(values.values.data(), host.mapped().data(), host.mapped().size());
    return values;
  }

  GpuImage image;
  Buffer host;
};

}  // namespace

struct OffscreenBuffers::State {
  State(const Device& device, VkExtent2D extent)
      : surface(device, extent, kSurfaceFormat, "surface"),
        weights(device, extent, kWeightsFormat, "weights"),
        confidence(device, extent, kConfidenceFormat, "confidence"),
        submission(device) {}
  Plane surface, weights, confidence;
  Submission submission;
};

OffscreenBuffers::OffscreenBuffers(const Device& device, VkExtent2D extent) {
  check(extent.width > 0 && extent.height > 0, ErrorCode::invalidInput, "offscreen buffers: extent {}×{} is empty",
        extent.width, extent.height);
  state_ = std::make_unique<State>(device, extent);
}
OffscreenBuffers::OffscreenBuffers(OffscreenBuffers&&) noexcept = default;
OffscreenBuffers& OffscreenBuffers::operator=(OffscreenBuffers&&) noexcept = default;
OffscreenBuffers::~OffscreenBuffers() = default;

BufferTargets OffscreenBuffers::targets() const noexcept {
  return {state_->surface.image.info().extent, state_->surface.target(), state_->weights.target(),
          state_->confidence.target()};
}

FrameBuffers OffscreenBuffers::render(const std::function<void(VkCommandBuffer)>& record) {
  State& s = *state_;
  s.submission.run([&](VkCommandBuffer commands) {
    record(commands);
    for (const Plane* plane : {&s.surface, &s.weights, &s.confidence}) plane->copy(commands);
    bufferBarrier(commands, use::kTransferWrite, use::kHostRead);
  });
  return {s.surface.values(), s.weights.values(), s.confidence.values()};
}

}  // namespace ibr
