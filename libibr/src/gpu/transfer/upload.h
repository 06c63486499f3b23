// SPDX-License-Identifier: Apache-2.0
// Uploads bytes from the host to buffers and images of the device: the one way in which constructors upload.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <tuple>
#include <utility>

#include "base/vulkan/buffer.h"
#include "base/vulkan/gpu_image.h"
#include "base/vulkan/submit.h"
#include "gpu/transfer/upload_batch.h"
#include "ibr/device.h"
#include "ibr/uploads.h"

namespace ibr {

/// Staging memory of objects that upload little. Larger uploads take several submissions.
inline constexpr VkDeviceSize kSmallStagingBytes = VkDeviceSize(1) << 20;

/// Collects uploads in staging memory. Without Uploads, the staging memory is bounded: a full one is submitted and
/// waited for, and flush() submits the rest and waits. With Uploads, nothing is submitted: flush() hands everything to
/// them. A constructor makes one Uploader for all its parts and flushes at its very end, because the destructor drops
/// what was not flushed: a constructor that throws leaves nothing behind. Calls throw Error (outOfMemory, deviceLost).
///
/// After flush(), or once the Uploads are recorded, all uploads are visible to later commands on the device's queue.
/// Targets must live until then and need VK_BUFFER/IMAGE_USAGE_TRANSFER_DST_BIT. Writes wait for earlier reads on the
/// same queue, so a layer may be replaced while frames are in flight. Later uploads overwrite earlier ones.
class Uploader {
 public:
  /// `stagingBytes`: maximum of one staging buffer; at least 1 MiB is used. Throws Error{invalidInput} where `uploads`
  /// were made for another device.
  explicit Uploader(const Device& device, Uploads* uploads = nullptr,
                    VkDeviceSize stagingBytes = VkDeviceSize(32) << 20);
  Uploader(const Uploader&) = delete;
  Uploader& operator=(const Uploader&) = delete;

  /// Uploads one whole level of one layer: rows of texels or blocks from the top, no padding; `extent` is the level's.
  /// The level ends in use::kSampled, whatever its previous use. Levels and layers without an upload keep their state
  /// (undefined in a new image) and must not be read.
  void image(const GpuImage& to, std::uint32_t layer, std::uint32_t level, VkExtent2D extent,
             std::span<const std::byte> bytes);
  /// Announces that image() uploads every level of every layer of `to`, each once, before flush(). Saves barriers: one
  /// for the image instead of one for each level of each layer.
  void beginImage(const GpuImage& to);
  void buffer(const Buffer& to, VkDeviceSize offset, std::span<const std::byte> bytes);
  /// Adds commands that come after all uploads so far, but before images of beginImage() can be read. `record` must not
  /// throw; it may own objects, which live as long as staging memory.
  void commands(std::function<void(VkCommandBuffer)> record);
  void flush();

 private:
  UploadStep& step();  // the last one
  void nextStep();
  VkDeviceSize room(VkDeviceSize atLeast);               // free bytes of the last staging buffer
  VkDeviceSize stage(std::span<const std::byte> bytes);  // at most room(1) bytes; returns their offset
  void submit();

  const Device* device_;
  Uploads* uploads_;
  VkDeviceSize maxBufferBytes_;
  std::optional<Submission> submission_;
  UploadBatch batch_;
  VkDeviceSize used_ = 0;                             // of the last staging buffer
  std::map<VkImage, VkImageSubresourceRange> begun_;  // by beginImage()
  // Targets of the last step, whose copies are not ordered among themselves; without images of beginImage().
  std::set<std::tuple<VkImage, std::uint32_t, std::uint32_t>> levels_;      // layer, level
  std::map<std::pair<VkBuffer, VkDeviceSize>, VkDeviceSize> bufferRanges_;  // first byte; byte after the last
};

}  // namespace ibr
