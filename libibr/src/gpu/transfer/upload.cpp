// SPDX-License-Identifier: Apache-2.0
#include "gpu/transfer/upload.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <iterator>

#include "base/check.h"
#include "base/vulkan/format.h"
#include "base/vulkan/functions.h"

namespace ibr {
namespace {

constexpr VkDeviceSize kAlignment = 16;  // bytes; a multiple of every texel and block, for copies
constexpr VkDeviceSize kMinStagingBytes = VkDeviceSize(1) << 20;  // bytes; holds a row of any image

}  // namespace

Uploader::Uploader(const Device& device, Uploads* uploads, VkDeviceSize stagingBytes)
    : device_(&device), uploads_(uploads), maxBufferBytes_(std::max(stagingBytes, kMinStagingBytes)) {
  check(!uploads || stateOf(*uploads).device == device.handle(), ErrorCode::invalidInput,
        "uploads were made for another device than '{}'", device.name());
}

void Uploader::image(const GpuImage& to, std::uint32_t layer, std::uint32_t level, VkExtent2D extent,
                     std::span<const std::byte> bytes) {
  const VkFormat format = to.info().format;
  const std::uint32_t side = blockSide(format), rowCount = blockCount(format, extent.height);
  const std::size_t rowBytes = std::size_t(blockCount(format, extent.width)) * blockBytes(format);
  assert(layer < to.info().layers && level < to.info().mipLevels);
  assert(extent.width == std::max(1u, to.info().extent.width >> level));
  assert(extent.height == std::max(1u, to.info().extent.height >> level));
  assert(rowBytes > 0 && rowBytes <= kMinStagingBytes && bytes.size() == rowBytes * rowCount);
  const std::tuple target{to.get(), layer, level};
  const VkImageSubresourceRange range{to.info().aspect, level, 1, layer, 1};
  const bool whole = begun_.contains(to.get());
  if (!whole && levels_.contains(target)) nextStep();
  if (!whole) step().begun.push_back({to.get(), range});
  for (std::uint32_t row = 0; row < rowCount;) {
    const auto rows = std::uint32_t(std::min<VkDeviceSize>(room(rowBytes) / rowBytes, rowCount - row));
    const VkDeviceSize offset = stage(bytes.subspan(row * rowBytes, rows * rowBytes));
    step().images.push_back({batch_.staging.back().get(),
                             to.get(),
                             {.bufferOffset = offset,
                              .imageSubresource = {to.info().aspect, level, layer, 1},
                              .imageOffset = {0, std::int32_t(row * side), 0},
                              .imageExtent = {extent.width, std::min(rows * side, extent.height - row * side), 1}}});
    row += rows;
  }
  if (whole) return;
  step().finished.push_back({to.get(), range});
  levels_.insert(target);
}

void Uploader::beginImage(const GpuImage& to) {
  const VkImageSubresourceRange range{to.info().aspect, 0, VK_REMAINING_MIP_LEVELS, 0, VK_REMAINING_ARRAY_LAYERS};
  if (begun_.emplace(to.get(), range).second) step().begun.push_back({to.get(), range});
}

void Uploader::buffer(const Buffer& to, VkDeviceSize offset, std::span<const std::byte> bytes) {
  assert(offset <= to.size() && bytes.size() <= to.size() - offset);
  if (bytes.empty()) return;
  // Of the ranges that begin before this one's end, the last one ends last, because ranges of a step do not overlap.
  const auto later = bufferRanges_.lower_bound({to.get(), offset + bytes.size()});
  if (later != bufferRanges_.begin()) {
    const auto& [first, end] = *std::prev(later);
    if (first.first == to.get() && end > offset) nextStep();
  }
  while (!bytes.empty()) {
    const std::size_t count = std::min<VkDeviceSize>(room(1), bytes.size());
    const VkDeviceSize from = stage(bytes.first(count));
    step().buffers.push_back({batch_.staging.back().get(), to.get(), {from, offset, count}});
    bufferRanges_[{to.get(), offset}] = offset + count;
    offset += count;
    bytes = bytes.subspan(count);
  }
}

void Uploader::commands(std::function<void(VkCommandBuffer)> record) {
  step().commands = std::move(record);
  nextStep();
}

void Uploader::flush() {
  for (const auto& [image, range] : begun_) step().finished.push_back({image, range});
  begun_.clear();
  if (!uploads_) {
    if (!batch_.steps.empty()) submit();
    batch_.staging.clear();
    return;
  }
  if (batch_.steps.empty()) return;
  UploadBatch& all = stateOf(*uploads_).batch;
  all.staging.reserve(all.staging.size() + batch_.staging.size());  // first, so that both are added or none
  all.steps.reserve(all.steps.size() + batch_.steps.size());
  std::ranges::move(batch_.staging, std::back_inserter(all.staging));
  std::ranges::move(batch_.steps, std::back_inserter(all.steps));
  batch_ = {};
  levels_.clear();
  bufferRanges_.clear();
}

UploadStep& Uploader::step() {
  if (batch_.steps.empty()) batch_.steps.emplace_back();
  return batch_.steps.back();
}

void Uploader::nextStep() {
  batch_.steps.emplace_back();
  levels_.clear();
  bufferRanges_.clear();
}

VkDeviceSize Uploader::room(VkDeviceSize atLeast) {
  const auto freeBytes = [&] {
    return batch_.staging.empty() ? VkDeviceSize(0) : batch_.staging.back().size() - used_;
  };
  if (freeBytes() >= atLeast) return freeBytes();
  if (!uploads_ && !batch_.staging.empty()) {
    submit();
    return freeBytes();
  }
  // Uploads that are handed over take as many buffers as needed, each as large as all before it.
  const VkDeviceSize bytes =
      uploads_ ? std::clamp(batch_.stagingBytes(), kMinStagingBytes, maxBufferBytes_) : maxBufferBytes_;
  batch_.staging.emplace_back(*device_, bytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, MemoryKind::upload, "upload staging");
  used_ = 0;
  return freeBytes();
}

VkDeviceSize Uploader::stage(std::span<const std::byte> bytes) {
  const Buffer& staging = batch_.staging.back();
  const VkDeviceSize offset = used_;
  std::memcpy(staging.mapped().data() + offset, bytes.data(), bytes.size());
  used_ = std::min(staging.size(), (offset + bytes.size() + kAlignment - 1) / kAlignment * kAlignment);
  return offset;
}

void Uploader::submit() {
  // Emptied first, so that the next upload starts clean even if this one throws.
  const std::vector<UploadStep> steps = std::exchange(batch_.steps, {});
  levels_.clear();
  bufferRanges_.clear();
  used_ = 0;
  if (!submission_) submission_.emplace(*device_);
  submission_->run([&](VkCommandBuffer commandBuffer) { recordSteps(commandBuffer, steps); });
}

}  // namespace ibr
