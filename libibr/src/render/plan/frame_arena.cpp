// SPDX-License-Identifier: Apache-2.0
#include "render/plan/frame_arena.h"

#include <algorithm>

namespace ibr {
namespace {

constexpr std::size_t kMinBlock = std::size_t(256) << 10;  // bytes

}  // namespace

void FrameArena::restart() {
  used_ = 0;
  if (blocks_.size() <= 1) return;
  std::size_t total = 0;
  for (const Block& block : blocks_) total += block.size;
  blocks_.clear();
  blocks_.push_back({std::make_unique_for_overwrite<std::byte[]>(total), total});
}

void* FrameArena::do_allocate(std::size_t bytes, std::size_t alignment) {
  for (;;) {
    if (!blocks_.empty()) {
      void* at = blocks_.back().bytes.get() + used_;
      std::size_t left = blocks_.back().size - used_;
      if (std::align(alignment, bytes, at, left)) {
        used_ = blocks_.back().size - left + bytes;
        return at;
      }
    }
    const std::size_t last = blocks_.empty() ? 0 : blocks_.back().size;
    const std::size_t size = std::max({kMinBlock, 2 * last, bytes + alignment});
    blocks_.push_back({std::make_unique_for_overwrite<std::byte[]>(size), size});
    used_ = 0;
  }
}

void FrameArena::do_deallocate(void* at, std::size_t bytes, std::size_t) {
  if (static_cast<std::byte*>(at) + bytes == blocks_.back().bytes.get() + used_) used_ -= bytes;
}

}  // namespace ibr
