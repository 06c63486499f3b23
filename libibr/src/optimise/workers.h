// SPDX-License-Identifier: Apache-2.0
// Runs work on many items with several threads.
#pragma once

#include <cstddef>
#include <functional>

namespace ibr {

/// Calls work(i) for all i < count, from `threads` threads (0: one per core) that take `block` items at once. An
/// exception of a call is thrown again after all threads have ended.
void forEachInParallel(std::size_t count, int threads, const std::function<void(std::size_t)>& work,
                       std::size_t block = 16);

}  // namespace ibr
