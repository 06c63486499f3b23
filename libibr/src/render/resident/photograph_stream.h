// SPDX-License-Identifier: Apache-2.0
// Copies textures into layers of texture arrays, piece by piece through a staging ring, in a caller's command buffers.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/vulkan/gpu_image.h"
#include "gpu/transfer/staging_ring.h"
#include "ibr/texture.h"

namespace ibr {

/// Layers of a texture array are in use::kSampled before and after each frame's commands. Only the constructor
/// allocates memory, and addArray() where it is called more than kMaxNewArrays times in a frame.
class PhotographStream {
 public:
  PhotographStream() = default;
  PhotographStream(const Device& device, std::uint64_t stagingBytes);

  /// Starts a frame. A repeated number means that the frame's commands were never submitted: record() then records all
  /// of them again.
  void begin(std::uint64_t frame, std::uint64_t completedFrame);

  /// Adds a new texture array in an undefined layout.
  void addArray(const GpuImage& array);

  /// Starts a copy of all levels of `texture`, smallest first. The texture must live until the copy is complete.
  /// Precondition: !busy().
  void start(const GpuImage& array, std::uint32_t layer, const Texture& texture);
  bool busy() const noexcept { return job_.has_value(); }

  /// Copies as much as fits into the ring, in at most kMaxCopies copies a frame. Returns true if the texture is
  /// complete: this frame's draws may use it.
  bool advance();

  /// Records the frame's commands. Waits for reads of earlier frames on the same queue.
  void record(VkCommandBuffer commandBuffer) const noexcept;

  std::uint64_t frameBytes() const noexcept { return frameBytes_; }  // copied since begin()

 private:
  static constexpr std::size_t kMaxNewArrays = 64;
  static constexpr std::size_t kMaxCopies = 1024;

  struct Job {
    VkImage image;
    VkFormat format;
    std::uint32_t layer;
    const Texture* texture;
    std::size_t level;  // the next level to copy
    std::uint32_t row;  // the next row of blocks
  };
  struct Copy {
    VkImage image;
    VkBufferImageCopy region;
  };

  StagingRing ring_;
  std::optional<Job> job_;
  std::uint64_t frame_ = 0, frameBytes_ = 0;
  std::vector<VkImage> newArrays_;  // of the frame
  std::vector<Copy> copies_;        // of the frame; copies into one layer are consecutive
};

}  // namespace ibr
