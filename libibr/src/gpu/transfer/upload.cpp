// SPDX-License-Identifier: Apache-2.0
#include "gpu/transfer/upload.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <utility>

#include "base/vulkan/barrier.h"
#include "base/vulkan/format.h"
#include "base/vulkan/functions.h"

namespace ibr {
namespace {

constexpr VkDeviceSize kAlignment = 16;  // bytes; a multiple of every texel and block, for copies
constexpr VkDeviceSize kMinStagingBytes = VkDeviceSize(1) << 20;  // bytes; holds a row of any image
constexpr VkDeviceSize kMaxOneShotStagingBytes = VkDeviceSize(32) << 20;

VkImageSubresourceRange levelOf(const VkImageSubresourceLayers& layers) {
  return {layers.aspectMask, layers.mipLevel, 1, layers.baseArrayLayer, 1};
}

}  // namespace

Uploader::Uploader(const Device& device, VkDeviceSize stagingBytes)
    : submission_(device),
      staging_(device, std::max(stagingBytes, kMinStagingBytes), VK_BUFFER_USAGE_TRANSFER_SRC_BIT, MemoryKind::upload,
               "upload staging") {}

void Uploader::image(const GpuImage& to, std::uint32_t layer, std::uint32_t level, VkExtent2D extent,
                     std::span<const std::byte> bytes) {
  assert(layer < to.info().layers && level < to.info().mipLevels);
  assert(extent.width == std::max(1u, to.info().extent.width >> level));
  assert(extent.height == std::max(1u, to.info().extent.height >> level));
  const std::size_t rowBytes = std::size_t(extent.width) * blockBytes(to.info().format);
  assert(blockSide(to.info().format) == 1 && rowBytes > 0 && rowBytes <= staging_.size() &&
         bytes.size() == rowBytes * extent.height);
  const VkImageSubresourceLayers subresource{to.info().aspect, level, layer, 1};
  const bool again = std::any_of(images_.begin(), images_.end(), [&](const ImagePiece& piece) {
    const VkImageSubresourceLayers& other = piece.region.imageSubresource;
    return piece.image == to.get() && other.mipLevel == level && other.baseArrayLayer == layer;
  });
  if (again) flush();  // copies of one batch are not ordered among themselves

  for (std::uint32_t row = 0; row < extent.height;) {
    const auto rows = std::uint32_t(std::min<VkDeviceSize>(freeBytes() / rowBytes, extent.height - row));
    if (rows == 0) {
      flush();
      continue;
    }
    const VkDeviceSize offset = stage(bytes.subspan(row * rowBytes, rows * rowBytes));
    images_.push_back({to.get(),
                       {.bufferOffset = offset,
                        .imageSubresource = subresource,
                        .imageOffset = {0, std::int32_t(row), 0},
                        .imageExtent = {extent.width, rows, 1}},
                       row == 0,
                       row + rows == extent.height});
    row += rows;
  }
}

void Uploader::buffer(const Buffer& to, VkDeviceSize offset, std::span<const std::byte> bytes) {
  assert(offset <= to.size() && bytes.size() <= to.size() - offset);
  const bool again = std::any_of(buffers_.begin(), buffers_.end(), [&](const BufferPiece& piece) {
    const VkBufferCopy& other = piece.region;
    return piece.buffer == to.get() && other.dstOffset < offset + bytes.size() && offset < other.dstOffset + other.size;
  });
  if (again) flush();

  while (!bytes.empty()) {
    const std::size_t count = std::min<VkDeviceSize>(freeBytes(), bytes.size());
    if (count == 0) {
      flush();
      continue;
    }
    buffers_.push_back({to.get(), {stage(bytes.first(count)), offset, count}});
    offset += count;
    bytes = bytes.subspan(count);
  }
}

void Uploader::flush() {
  if (images_.empty() && buffers_.empty()) return;
  // Emptied first, so that the next upload starts clean even if this one throws.
  const auto images = std::exchange(images_, {});
  const auto buffers = std::exchange(buffers_, {});
  used_ = 0;
  submission_.run([&](VkCommandBuffer commands) {
    constexpr ImageUse kReplaced{VK_IMAGE_LAYOUT_UNDEFINED, use::kAllCommands.stages, VK_ACCESS_2_NONE};
    constexpr ImageUse kReadable{use::kSampled.layout, use::kAllCommands.stages, VK_ACCESS_2_MEMORY_READ_BIT};
    for (const ImagePiece& piece : images)
      if (piece.first)
        transition(commands, piece.image, kReplaced, use::kTransferDestination, levelOf(piece.region.imageSubresource));
    if (!buffers.empty()) bufferBarrier(commands, use::kAllCommands, use::kTransferWrite);
    for (const ImagePiece& piece : images)
      vkCmdCopyBufferToImage(commands, staging_.get(), piece.image, use::kTransferDestination.layout, 1, &piece.region);
    for (const BufferPiece& piece : buffers) vkCmdCopyBuffer(commands, staging_.get(), piece.buffer, 1, &piece.region);
    if (!buffers.empty()) bufferBarrier(commands, use::kTransferWrite, use::kAllCommands);
    for (const ImagePiece& piece : images)
      if (piece.last)
        transition(commands, piece.image, use::kTransferDestination, kReadable, levelOf(piece.region.imageSubresource));
  });
}

VkDeviceSize Uploader::freeBytes() const {
  return staging_.size() - used_;
}

VkDeviceSize Uploader::stage(std::span<const std::byte> bytes) {
  const VkDeviceSize offset = used_;
  std::memcpy(staging_.mapped().data() + offset, bytes.data(), bytes.size());
  used_ = std::min(staging_.size(), (offset + bytes.size() + kAlignment - 1) / kAlignment * kAlignment);
  return offset;
}

void uploadBuffer(const Device& device, const Buffer& to, VkDeviceSize offset, std::span<const std::byte> bytes) {
  if (bytes.empty()) return;
  Uploader uploader(device, std::min<VkDeviceSize>(bytes.size(), kMaxOneShotStagingBytes));
  uploader.buffer(to, offset, bytes);
  uploader.flush();
}

}  // namespace ibr
