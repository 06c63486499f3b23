// SPDX-License-Identifier: Apache-2.0
#include "support/allocation_count.h"

#include <algorithm>
#include <cstdlib>
#include <new>

namespace {

thread_local std::size_t allocations = 0;

void* counted(std::size_t bytes, std::size_t alignment) {
  ++allocations;
  const std::size_t whole = (std::max(bytes, std::size_t(1)) + alignment - 1) / alignment * alignment;
  if (void* at = std::aligned_alloc(alignment, whole)) return at;
  throw std::bad_alloc();
}

}  // namespace

// The array forms call these.
void* operator new(std::size_t bytes) {
  return counted(bytes, alignof(std::max_align_t));
}
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return counted(bytes, std::size_t(alignment));
}
void operator delete(void* at) noexcept {
  std::free(at);
}
void operator delete(void* at, std::size_t) noexcept {
  std::free(at);
}
void operator delete(void* at, std::align_val_t) noexcept {
  std::free(at);
}
void operator delete(void* at, std::size_t, std::align_val_t) noexcept {
  std::free(at);
}

namespace ibr::test {

std::size_t allocationCount() {
  return allocations;
}

}  // namespace ibr::test
