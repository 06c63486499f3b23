// SPDX-License-Identifier: Apache-2.0
#include "gpu/transfer/staging_ring.h"

#include <algorithm>
#include <cassert>

namespace ibr {
namespace {

constexpr VkDeviceSize kAlignment = 16;  // bytes; a multiple of every texel and block, for copies

constexpr VkDeviceSize aligned(VkDeviceSize bytes) {
  return (bytes + kAlignment - 1) / kAlignment * kAlignment;
}

}  // namespace

StagingRing::StagingRing(const Device& device, VkDeviceSize bytes)
    : buffer_(device, aligned(bytes), VK_BUFFER_USAGE_TRANSFER_SRC_BIT, MemoryKind::upload, "staging ring") {}

VkDeviceSize StagingRing::freeBytes() const noexcept {
  if (allocations_.empty()) return buffer_.size();
  const VkDeviceSize tail = allocations_.front().begin;
  return head_ > tail ? std::max(buffer_.size() - head_, tail) : tail - head_;
}

StagingRing::Piece StagingRing::allocate(VkDeviceSize bytes, std::uint64_t frame) {
  assert(bytes > 0 && bytes <= freeBytes());
  assert(allocations_.empty() || allocations_.back().frame <= frame);
  if (allocations_.empty() || buffer_.size() - head_ < bytes) head_ = 0;
  const Piece piece{head_, buffer_.mapped().subspan(head_, bytes)};
  head_ += aligned(bytes);
  allocations_.push_back({piece.offset, head_, frame});
  return piece;
}

void StagingRing::release(std::uint64_t completedFrame) {
  while (!allocations_.empty() && allocations_.front().frame <= completedFrame) allocations_.pop_front();
}

}  // namespace ibr
