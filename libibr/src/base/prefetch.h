// SPDX-License-Identifier: Apache-2.0
// Starts to load memory into the cache before it is read. Changes no results.
#pragma once

#include <cstddef>

namespace ibr {

constexpr std::size_t kCacheLine = 64;  // bytes; other sizes only change the time

/// `bytes` from `first` on; may lie anywhere.
inline void prefetch([[maybe_unused]] const void* first, [[maybe_unused]] std::size_t bytes) {
#if defined(__GNUC__)
  for (std::size_t at = 0; at < bytes; at += kCacheLine) __builtin_prefetch(static_cast<const char*>(first) + at);
#endif
}

template <class Value>
void prefetch(const Value& value) {
  prefetch(&value, sizeof value);
}

}  // namespace ibr
