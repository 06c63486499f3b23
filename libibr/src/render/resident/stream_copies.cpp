// SPDX-License-Identifier: Apache-2.0
#include "render/resident/stream_copies.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "base/vulkan/barrier.h"
#include "base/vulkan/format.h"
#include "base/vulkan/functions.h"

namespace ibr {
namespace {

// Reads of texture arrays in all shader stages; nothing else uses the arrays.
constexpr ImageUse kReadable{use::kSampled.layout, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_READ_BIT};
// Overlays read meshes as storage buffers.
constexpr BufferUse kMeshRead{
    VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT | VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT,
    VK_ACCESS_2_INDEX_READ_BIT | VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_READ_BIT};
constexpr std::size_t kMaxLevels = 16;  // of a texture: sides below 65536 px

}  // namespace

StreamCopies::StreamCopies(const Device& device, std::uint64_t stagingBytes, std::size_t maxLoads)
    : staging_(device, stagingBytes, kMaxPieces + maxLoads) {
  newArrays_.reserve(kMaxNewArrays);
  textures_.reserve(kMaxTextures);
  meshes_.reserve(kMaxMeshes);
}

void StreamCopies::begin(std::uint64_t frame, std::uint64_t completedFrame) {
  assert(frame >= frame_);
  staging_.release(completedFrame);
  frameBytes_ = 0;
  if (frame == frame_) return;
  frame_ = frame;
  newArrays_.clear();
  textures_.clear();
  meshes_.clear();
}

void StreamCopies::addArray(const GpuImage& array) {
  newArrays_.push_back(array.get());
}

bool StreamCopies::hasRoom() const noexcept {
  return textures_.size() < kMaxTextures && meshes_.size() < kMaxMeshes;
}

void StreamCopies::takeOver(const StagingPool::Piece& piece) {
  staging_.releaseAfter(piece, frame_);
  frameBytes_ += piece.memory.size();
}

void StreamCopies::copyTexture(const GpuImage& array, std::uint32_t layer, const StagingPool::Piece& piece) {
  const GpuImageInfo& info = array.info();
  assert(hasRoom() && info.mipLevels <= kMaxLevels);
  textures_.push_back({array.get(), info.format, info.extent, info.mipLevels, layer, piece.offset});
  takeOver(piece);
}

void StreamCopies::copyMesh(const Buffer& to, VkDeviceSize offset, const StagingPool::Piece& piece) {
  assert(hasRoom());
  meshes_.push_back({to.get(), {piece.offset, offset, piece.memory.size()}});
  takeOver(piece);
}

void StreamCopies::record(VkCommandBuffer commandBuffer) const noexcept {
  for (const VkImage array : newArrays_) transition(commandBuffer, array, use::kUndefined, kReadable);
  recordTextures(commandBuffer);
  recordMeshes(commandBuffer);
}

void StreamCopies::recordTextures(VkCommandBuffer commandBuffer) const noexcept {
  const auto forLayers = [&](ImageUse from, ImageUse to) {
    for (const TextureCopy& copy : textures_)
      transition(commandBuffer, copy.image, from, to, {VK_IMAGE_ASPECT_COLOR_BIT, 0, copy.levels, copy.layer, 1});
  };
  forLayers(kReadable, use::kTransferDestination);
  for (const TextureCopy& copy : textures_) {
    std::array<VkBufferImageCopy, kMaxLevels> regions;
    VkDeviceSize offset = copy.offset;
    for (std::uint32_t level = 0; level < copy.levels; ++level) {
      const VkExtent2D size{std::max(1u, copy.extent.width >> level), std::max(1u, copy.extent.height >> level)};
      regions[level] = {.bufferOffset = offset,
                        .bufferRowLength = 0,
                        .bufferImageHeight = 0,
                        .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, level, copy.layer, 1},
                        .imageOffset = {0, 0, 0},
                        .imageExtent = {size.width, size.height, 1}};
      offset += VkDeviceSize(blockCount(copy.format, size.width)) * blockCount(copy.format, size.height) *
                blockBytes(copy.format);
    }
    vkCmdCopyBufferToImage(commandBuffer, staging_.buffer(), copy.image, use::kTransferDestination.layout, copy.levels,
                           regions.data());
  }
  forLayers(use::kTransferDestination, kReadable);
}

// No barrier before the copies: a slot is reused only after the frames that read it.
void StreamCopies::recordMeshes(VkCommandBuffer commandBuffer) const noexcept {
  if (meshes_.empty()) return;
  for (const MeshCopy& copy : meshes_) vkCmdCopyBuffer(commandBuffer, staging_.buffer(), copy.to, 1, &copy.region);
  bufferBarrier(commandBuffer, use::kTransferWrite, kMeshRead);
}

}  // namespace ibr
