// SPDX-License-Identifier: Apache-2.0
// Bytes from the host into buffers and images of the device.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gpu/transfer/buffer.h"
#include "gpu/transfer/gpu_image.h"
#include "gpu/transfer/submit.h"
#include "ibr/device.h"

namespace ibr {

/// Gathers uploads in a staging buffer of bounded size and submits whenever it is full; one larger than the buffer goes
/// in pieces. After flush() everything is visible to all commands that are submitted later to the device's queue. What
/// was not flushed when the uploader goes is dropped. Calls throw Error (outOfMemory, deviceLost).
///
/// Targets must live until flush() and need VK_BUFFER/IMAGE_USAGE_TRANSFER_DST_BIT. Writing waits for earlier shader
/// reads on the same queue, so a layer may be replaced while frames are in flight.
class Uploader {
 public:
  explicit Uploader(const Device& device, VkDeviceSize stagingBytes = VkDeviceSize(32) << 20);

  /// One level of one layer, whole, in a format without blocks: rows from the top, no padding; `extent` is the
  /// level's. It ends in use::kSampled whatever it was before. Levels and layers that were never uploaded stay as
  /// they were (undefined in a new image) and must not be read; they need no preparation.
  void image(const GpuImage& to, std::uint32_t layer, std::uint32_t level, VkExtent2D extent,
             std::span<const std::byte> bytes);
  void buffer(const Buffer& to, VkDeviceSize offset, std::span<const std::byte> bytes);
  void flush();

 private:
  struct ImagePiece {
    VkImage image;
    VkBufferImageCopy region;
    bool first, last;  // of its level
  };
  struct BufferPiece {
    VkBuffer buffer;
    VkBufferCopy region;
  };

  VkDeviceSize room() const;
  VkDeviceSize stage(std::span<const std::byte> bytes);  // what fits into room(); returns its place

  Submission submission_;
  Buffer staging_;
  VkDeviceSize used_ = 0;
  std::vector<ImagePiece> images_;
  std::vector<BufferPiece> buffers_;
};

/// One upload with its own staging buffer, finished on return.
void uploadBuffer(const Device& device, const Buffer& to, VkDeviceSize offset, std::span<const std::byte> bytes);

}  // namespace ibr
