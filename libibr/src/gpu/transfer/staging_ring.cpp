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
  if (count_ == 0) return buffer_.size();
  if (count_ == kMaxRanges) return 0;
  const VkDeviceSize tail = range(0).begin;
  return head_ > tail ? std::max(buffer_.size() - head_, tail) : tail - head_;
}

StagingRing::Piece StagingRing::allocate(VkDeviceSize bytes, std::uint64_t frame) {
  assert(bytes > 0 && bytes <= freeBytes());
  assert(count_ == 0 || range(count_ - 1).frame <= frame);
  if (count_ == 0 || buffer_.size() - head_ < bytes) head_ = 0;
  const Piece piece{head_, buffer_.mapped().subspan(head_, bytes)};
  head_ += aligned(bytes);
  if (count_ > 0 && range(count_ - 1).frame == frame && range(count_ - 1).end == piece.offset)
    range(count_ - 1).end = head_;
  else
    range(count_++) = {piece.offset, head_, frame};
  return piece;
}

void StagingRing::release(std::uint64_t completedFrame) {
  for (; count_ > 0 && range(0).frame <= completedFrame; --count_) first_ = (first_ + 1) % kMaxRanges;
}

}  // namespace ibr
