// SPDX-License-Identifier: Apache-2.0
#include "render/resident/photograph_stream.h"

#include <algorithm>
#include <cassert>
#include <cstring>

#include "base/vulkan/barrier.h"
#include "base/vulkan/format.h"
#include "base/vulkan/functions.h"

namespace ibr {
namespace {

// Reads of texture arrays in all shader stages; nothing else uses the arrays.
constexpr ImageUse kReadable{use::kSampled.layout, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_READ_BIT};
constexpr VkDeviceSize kMinRingBytes = VkDeviceSize(1) << 20;  // room for several rows of any image

}  // namespace

PhotographStream::PhotographStream(const Device& device, std::uint64_t stagingBytes)
    : ring_(device, std::max<VkDeviceSize>(stagingBytes, kMinRingBytes)) {
  newArrays_.reserve(kMaxNewArrays);
  copies_.reserve(kMaxCopies);
}

void PhotographStream::begin(std::uint64_t frame, std::uint64_t completedFrame) {
  assert(frame >= frame_);
  ring_.release(completedFrame);
  frameBytes_ = 0;
  if (frame == frame_) return;
  frame_ = frame;
  newArrays_.clear();
  copies_.clear();
}

void PhotographStream::addArray(const GpuImage& array) {
  newArrays_.push_back(array.get());
}

void PhotographStream::start(const GpuImage& array, std::uint32_t layer, const Texture& texture) {
  assert(!job_ && !texture.levels.empty() && texture.levels.size() == array.info().mipLevels);
  const std::size_t smallest = texture.levels.size() - 1;
  job_ = Job{array.get(), array.info().format, layer, &texture, smallest, 0};
}

bool PhotographStream::advance() {
  Job& job = *job_;
  while (copies_.size() < kMaxCopies) {
    const auto width = std::uint32_t(std::max(1, job.texture->width >> job.level));
    const auto height = std::uint32_t(std::max(1, job.texture->height >> job.level));
    const std::vector<std::byte>& bytes = job.texture->levels[job.level];
    const std::size_t rowBytes = std::size_t(blockCount(job.format, width)) * blockBytes(job.format);
    const std::uint32_t rowCount = blockCount(job.format, height), side = blockSide(job.format);
    assert(bytes.size() == rowBytes * rowCount);
    const auto rows = std::uint32_t(std::min<VkDeviceSize>(ring_.freeBytes() / rowBytes, rowCount - job.row));
    if (rows == 0) return false;
    const StagingRing::Piece piece = ring_.allocate(rows * rowBytes, frame_);
    std::memcpy(piece.memory.data(), &bytes[job.row * rowBytes], piece.memory.size());
    frameBytes_ += piece.memory.size();
    copies_.push_back({job.image,
                       {.bufferOffset = piece.offset,
                        .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, std::uint32_t(job.level), job.layer, 1},
                        .imageOffset = {0, std::int32_t(job.row * side), 0},
                        .imageExtent = {width, std::min(rows * side, height - job.row * side), 1}}});
    job.row += rows;
    if (job.row < rowCount) continue;
    job.row = 0;
    if (job.level == 0) {
      job_.reset();
      return true;
    }
    --job.level;
  }
  return false;
}

void PhotographStream::record(VkCommandBuffer commandBuffer) const noexcept {
  for (const VkImage array : newArrays_) transition(commandBuffer, array, use::kUndefined, kReadable);
  const auto forLayers = [&](ImageUse from, ImageUse to) {
    for (auto first = copies_.begin(); first != copies_.end();) {
      const VkImageSubresourceLayers& of = first->region.imageSubresource;
      const auto last = std::find_if(first, copies_.end(), [&](const Copy& copy) {
        return copy.image != first->image || copy.region.imageSubresource.baseArrayLayer != of.baseArrayLayer;
      });
      const std::uint32_t low = std::prev(last)->region.imageSubresource.mipLevel;  // smallest levels come first
      transition(commandBuffer, first->image, from, to,
                 {of.aspectMask, low, of.mipLevel - low + 1, of.baseArrayLayer, 1});
      first = last;
    }
  };
  forLayers(kReadable, use::kTransferDestination);
  for (const Copy& copy : copies_)
    vkCmdCopyBufferToImage(commandBuffer, ring_.buffer(), copy.image, use::kTransferDestination.layout, 1,
                           &copy.region);
  forLayers(use::kTransferDestination, kReadable);
}

}  // namespace ibr
