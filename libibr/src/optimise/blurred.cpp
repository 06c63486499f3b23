// SPDX-License-Identifier: Apache-2.0
#include "optimise/blurred.h"

#include <algorithm>
#include <array>

#include "optimise/workers.h"

namespace ibr {
namespace {

constexpr std::array<std::uint32_t, 5> kBinomial{1, 4, 6, 4, 1};
constexpr std::uint32_t kPair = 0x00ff00ffu;  // selects two channels of a word, 16 bits each
constexpr std::uint32_t kHalf = 0x00080008u;

// Words become unsigned, then two channels are added at once: the weights sum to 16, so nothing overflows.
std::uint32_t mixed(const std::array<std::uint32_t, 5>& words) {
  std::uint32_t even = kHalf, odd = kHalf;
  for (std::size_t k = 0; k < 5; ++k) {
    const std::uint32_t word = words[k] ^ 0x808080u;
    even += kBinomial[k] * (word & kPair);
    odd += kBinomial[k] * (word >> 8 & kPair);
  }
  return ((even >> 4 & kPair) | (odd >> 4 & kPair) << 8) ^ 0x808080u;
}

int rowsOf(const Texels& texels) {
  return int((texels.words.size() - kTexelOverrun) / std::size_t(texels.stride));
}

// Blurs along rows (stride 1) or columns; `length` is the number of texels in that direction.
Texels blurredAlong(const Texels& from, std::ptrdiff_t stride, int length, int hole, int threads) {
  const auto rows = rowsOf(from);
  Texels to = from;
  forEachInParallel(std::size_t(rows), threads, [&](std::size_t row) {
    for (int x = 0; x < from.stride; ++x) {
      const std::size_t index = row * std::size_t(from.stride) + std::size_t(x);
      const int here = stride == 1 ? x : int(row);
      std::array<std::uint32_t, 5> words;
      for (int k = -2; k <= 2; ++k) {
        const int there = std::clamp(here + k * hole, 0, length - 1);
        words[std::size_t(k + 2)] = from.words[std::size_t(std::ptrdiff_t(index) + (there - here) * stride)];
      }
      to.words[index] = mixed(words);
    }
  });
  return to;
}

}  // namespace

Texels blurred(const Texels& before, int level, int threads) {
  const int hole = 1 << (level - 1);
  const Texels across = blurredAlong(before, 1, before.stride, hole, threads);
  return blurredAlong(across, before.stride, rowsOf(before), hole, threads);
}

}  // namespace ibr
