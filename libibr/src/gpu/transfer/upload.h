// SPDX-License-Identifier: Apache-2.0
// Uploads bytes from the host to buffers and images of the device.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/vulkan/buffer.h"
#include "base/vulkan/gpu_image.h"
#include "base/vulkan/submit.h"
#include "ibr/device.h"

namespace ibr {

/// Collects uploads in a staging buffer of bounded size and submits when the buffer is full; larger uploads go in
/// pieces. After flush() all uploads are visible to later submissions to the device's queue. The destructor drops
/// uploads that were not flushed. Calls throw Error (outOfMemory, deviceLost).
///
/// Targets must live until flush() and need VK_BUFFER/IMAGE_USAGE_TRANSFER_DST_BIT. Writes wait for earlier shader
/// reads on the same queue, so a layer may be replaced while frames are in flight.
class Uploader {
 public:
  explicit Uploader(const Device& device, VkDeviceSize stagingBytes = VkDeviceSize(32) << 20);

  /// Uploads one whole level of one layer, in an uncompressed format: rows from the top, no padding; `extent` is the
  /// level's. The level ends in use::kSampled, whatever its previous use. Levels and layers without an upload keep
  /// their state (undefined in a new image) and must not be read.
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

  VkDeviceSize freeBytes() const;
  VkDeviceSize stage(std::span<const std::byte> bytes);  // copies as much as fits into freeBytes(); returns the offset

  Submission submission_;
  Buffer staging_;
  VkDeviceSize used_ = 0;
  std::vector<ImagePiece> images_;
  std::vector<BufferPiece> buffers_;
};

/// Uploads once with its own staging buffer; finished on return.
void uploadBuffer(const Device& device, const Buffer& to, VkDeviceSize offset, std::span<const std::byte> bytes);

}  // namespace ibr
