// SPDX-License-Identifier: Apache-2.0
// Working memory of planning: allocation moves a pointer, and all is freed at once before the next frame.
//
//   FrameArena& arena = ...;
//   arena.restart();
//   std::pmr::vector<int> temporary(&arena);  // no heap allocation once the arena has seen such a frame
#pragma once

#include <cstddef>
#include <memory>
#include <memory_resource>
#include <vector>

namespace ibr {

/// Not thread-safe. Keeps one block, at least as large as the largest frame so far. Of single deallocations only that
/// of the last allocation makes its memory available again.
class FrameArena final : public std::pmr::memory_resource {
 public:
  /// Frees everything. Objects in the arena must be destroyed or abandoned.
  void restart();

 private:
  struct Block {
    std::unique_ptr<std::byte[]> bytes;
    std::size_t size = 0;
  };

  void* do_allocate(std::size_t bytes, std::size_t alignment) override;
  void do_deallocate(void* at, std::size_t bytes, std::size_t alignment) override;
  bool do_is_equal(const memory_resource& other) const noexcept override { return this == &other; }

  std::vector<Block> blocks_;
  std::size_t used_ = 0;  // bytes of the last block
};

}  // namespace ibr
