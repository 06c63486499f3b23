// SPDX-License-Identifier: Apache-2.0
// Copies of textures and meshes from staging memory, in a caller's command buffers.
#pragma once

#include <cstdint>
#include <vector>

#include "base/vulkan/buffer.h"
#include "base/vulkan/gpu_image.h"
#include "gpu/transfer/staging_pool.h"

namespace ibr {

/// Layers of a texture array are in use::kSampled before and after each frame's commands. Only the constructor
/// allocates memory, and addArray() where it is called more than kMaxNewArrays times in a frame.
class StreamCopies {
 public:
  StreamCopies() = default;
  /// `maxLoads`: pieces that jobs write at a time.
  StreamCopies(const Device& device, std::uint64_t stagingBytes, std::size_t maxLoads);

  StagingPool& staging() noexcept { return staging_; }

  /// Starts a frame. A repeated number means that the frame's commands were never submitted: record() then records all
  /// of them again.
  void begin(std::uint64_t frame, std::uint64_t completedFrame);

  /// Adds a new texture array in an undefined layout.
  void addArray(const GpuImage& array);

  /// False: the frame has too many copies for another one.
  bool hasRoom() const noexcept;
  /// Copies all levels into a layer; takes over the piece. This frame's draws may use the texture.
  void copyTexture(const GpuImage& array, std::uint32_t layer, const StagingPool::Piece& piece);
  /// Copies the piece into a buffer's range that no frame in flight reads, and takes it over.
  void copyMesh(const Buffer& to, VkDeviceSize offset, const StagingPool::Piece& piece);

  /// Records the frame's commands. Waits for reads of textures by earlier frames on the same queue.
  void record(VkCommandBuffer commandBuffer) const noexcept;

  std::uint64_t frameBytes() const noexcept { return frameBytes_; }  // copied since begin()

 private:
  static constexpr std::size_t kMaxNewArrays = 64;
  static constexpr std::size_t kMaxTextures = 256, kMaxMeshes = 1024;  // copies of a frame
  static constexpr std::size_t kMaxPieces = 4096;                      // that frames in flight read

  struct TextureCopy {
    VkImage image;
    VkFormat format;
    VkExtent2D extent;  // of level 0
    std::uint32_t levels, layer;
    VkDeviceSize offset;  // in staging memory
  };
  struct MeshCopy {
    VkBuffer to;
    VkBufferCopy region;
  };

  void takeOver(const StagingPool::Piece& piece);
  void recordTextures(VkCommandBuffer commandBuffer) const noexcept;
  void recordMeshes(VkCommandBuffer commandBuffer) const noexcept;

  StagingPool staging_;
  std::uint64_t frame_ = 0, frameBytes_ = 0;
  std::vector<VkImage> newArrays_;  // of the frame, as the following
  std::vector<TextureCopy> textures_;
  std::vector<MeshCopy> meshes_;
};

}  // namespace ibr
