// SPDX-License-Identifier: Apache-2.0
#include "vr/headset/eye_capture.h"

#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"

namespace ibr::app {

void EyeCapture::record(VkCommandBuffer commands, const EyeImages& images) {
  extent_ = images.extent();
  blueFirst_ = images.format() == VK_FORMAT_B8G8R8A8_SRGB || images.format() == VK_FORMAT_B8G8R8A8_UNORM;
  const VkDeviceSize size = VkDeviceSize(4) * extent_.width * extent_.height;
  for (std::uint32_t eye = 0; eye < 2; ++eye) {
    if (bytes_[eye].size() < size)
      bytes_[eye] = Buffer(device_, size, VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryKind::readback, "an eye's image");
    const EyeImages::Picture picture = images.picture(eye);
    const VkImageSubresourceRange layer{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, picture.layer, 1};
    transition(commands, picture.image, use::kColourAttachment, use::kTransferSource, layer);
    const VkBufferImageCopy region{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, picture.layer, 1},
                                   .imageExtent = {extent_.width, extent_.height, 1}};
    vkCmdCopyImageToBuffer(commands, picture.image, use::kTransferSource.layout, bytes_[eye].get(), 1, &region);
    transition(commands, picture.image, use::kTransferSource, use::kColourAttachment, layer);
  }
  bufferBarrier(commands, use::kTransferWrite, use::kHostRead);
}

void EyeCapture::submitted(std::uint64_t frame) noexcept {
  frame_ = frame;
  free_ = false;
}

std::array<Image8, 2> EyeCapture::read() const {
  std::array<Image8, 2> pictures;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    Image8& picture = pictures[eye] = Image8(int(extent_.width), int(extent_.height), 3);
    const auto* from = reinterpret_cast<const std::uint8_t*>(bytes_[eye].mapped().data());
    for (std::size_t i = 0; i < picture.values.size() / 3; ++i)
      for (std::size_t c = 0; c < 3; ++c) picture.values[3 * i + c] = from[4 * i + (blueFirst_ ? 2 - c : c)];
  }
  return pictures;
}

}  // namespace ibr::app
