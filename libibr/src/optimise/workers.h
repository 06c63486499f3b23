// SPDX-License-Identifier: Apache-2.0
// Work on many items by several threads.
#pragma once

#include <cstddef>
#include <functional>

namespace ibr {

/// Calls work(i) for all i < count, from `threads` threads (0 = one a core) that take `block` items at once. What a
/// call throws is thrown here, after all have ended.
void forEachInParallel(std::size_t count, int threads, const std::function<void(std::size_t)>& work,
                       std::size_t block = 16);

}  // namespace ibr
