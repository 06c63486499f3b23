// SPDX-License-Identifier: Apache-2.0
#include "gpu/transfer/staging_pool.h"

#include <algorithm>
#include <cassert>

namespace ibr {
namespace {

constexpr VkDeviceSize kAlignment = 16;  // bytes; a multiple of every texel and block, for copies

constexpr VkDeviceSize aligned(VkDeviceSize bytes) {
  return (bytes + kAlignment - 1) / kAlignment * kAlignment;
}

}  // namespace

StagingPool::StagingPool(const Device& device, VkDeviceSize bytes, std::size_t maxPieces)
    : buffer_(device, aligned(bytes), VK_BUFFER_USAGE_TRANSFER_SRC_BIT, MemoryKind::upload, "staging pool") {
  used_.reserve(maxPieces);
}

std::optional<StagingPool::Piece> StagingPool::take(VkDeviceSize bytes) {
  assert(bytes > 0);
  if (used_.size() == used_.capacity()) return std::nullopt;
  VkDeviceSize begin = 0;
  auto next = used_.begin();
  while (next != used_.end() && next->begin - begin < aligned(bytes)) begin = (next++)->end;
  if (buffer_.size() - begin < aligned(bytes)) return std::nullopt;
  used_.insert(next, {begin, begin + aligned(bytes), kTaken});
  return Piece{begin, buffer_.mapped().subspan(begin, bytes)};
}

std::vector<StagingPool::Range>::iterator StagingPool::find(const Piece& piece) {
  const auto found = std::ranges::lower_bound(used_, piece.offset, {}, &Range::begin);
  assert(found != used_.end() && found->begin == piece.offset && found->frame == kTaken);
  return found;
}

void StagingPool::release(const Piece& piece) {
  used_.erase(find(piece));
}

void StagingPool::releaseAfter(const Piece& piece, std::uint64_t frame) {
  find(piece)->frame = frame;
}

void StagingPool::release(std::uint64_t completedFrame) {
  std::erase_if(used_, [&](const Range& range) { return range.frame != kTaken && range.frame <= completedFrame; });
}

}  // namespace ibr
