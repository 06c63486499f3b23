// SPDX-License-Identifier: Apache-2.0
// Copies of textures into layers of pages, piece by piece through a staging ring, in the caller's command buffers.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "gpu/transfer/gpu_image.h"
#include "gpu/transfer/staging_ring.h"
#include "ibr/texture.h"

namespace ibr {

/// A page's layers are in use::kSampled before and after each frame's commands.
class PhotographStream {
 public:
  PhotographStream() = default;
  PhotographStream(const Device& device, std::uint64_t stagingBytes);

  /// With the number of the frame before: its commands were never submitted, and all of them are recorded again.
  void begin(std::uint64_t frame, std::uint64_t completedFrame);

  /// A new page, undefined so far.
  void addPage(const GpuImage& page);

  /// The levels of `texture`, the smallest first. One at a time: not before the last one is finished.
  void start(const GpuImage& page, std::uint32_t layer, Texture texture);
  bool busy() const noexcept { return job_.has_value(); }

  /// Copies what fits into the ring. True: the texture is finished, and there for the frame's draws.
  bool advance();

  /// Records the frame's commands. Waits for earlier frames' reads on the same queue.
  void record(VkCommandBuffer commandBuffer) const noexcept;

  /// The same without barriers, for pages that nobody reads yet: their layers are in use::kTransferDestination.
  void recordCopies(VkCommandBuffer commandBuffer) const noexcept;

  std::uint64_t frameBytes() const noexcept { return frameBytes_; }  // copied since `begin`

 private:
  struct Job {
    VkImage image;
    VkFormat format;
    std::uint32_t layer;
    Texture texture;
    std::size_t level;  // the next one
    std::uint32_t row;  // of blocks
  };
  struct Copy {
    VkImage image;
    VkBufferImageCopy region;
  };

  StagingRing ring_;
  std::optional<Job> job_;
  std::uint64_t frame_ = 0, frameBytes_ = 0;
  std::vector<VkImage> newPages_;  // of the frame
  std::vector<Copy> copies_;       // likewise; those of a layer one after another
};

}  // namespace ibr
