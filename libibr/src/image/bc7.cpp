// SPDX-License-Identifier: Apache-2.0
//
// Bits of a block in mode 6, from the lowest: 0000001 (mode), R0 R1 G0 G1 B0 B1 A0 A1 of 7 each, P0 P1, the first
// pixel's index without its highest bit, which is 0, and fifteen indices of 4.
//
// The endpoints start at the ends of the colours' principal axis. Then, until nothing improves: all four pairs of
// p-bits are tried, and pixels choose the nearest point. The endpoints are solved by least squares for the best
// choices.
#include "image/bc7.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "image/principal_axis.h"

namespace ibr {
namespace {

constexpr std::array<int, 16> kWeights{0, 4, 9, 13, 17, 21, 26, 30, 34, 38, 43, 47, 51, 55, 60, 64};  // of 64

int between(int first, int second, int weight) noexcept {
  return (first * (64 - weight) + second * weight + 32) >> 6;
}

using Colour = std::array<int, 4>;  // 0 to 255

struct Trial {
  Colour first{}, second{};  // the lowest bit of all channels is the p-bit
  std::array<int, 16> indices{};
  int error = std::numeric_limits<int>::max();  // sum of squares
};

int errorOf(const std::array<std::uint8_t, 4>& pixel, const Trial& trial, int index) noexcept {
  int error = 0;
  for (std::size_t c = 0; c < 4; ++c) {
    const int d = pixel[c] - between(trial.first[c], trial.second[c], kWeights[std::size_t(index)]);
    error += d * d;
  }
  return error;
}

Trial choose(const BlockPixels& pixels, const Colour& first, const Colour& second) noexcept {
  Trial trial{first, second, {}, 0};
  double length = 0;
  std::array<double, 4> axis;
  for (std::size_t c = 0; c < 4; ++c) {
    axis[c] = second[c] - first[c];
    length += axis[c] * axis[c];
  }
  for (std::size_t p = 0; p < pixels.size(); ++p) {
    double along = 0;
    for (std::size_t c = 0; c < 4; ++c) along += (pixels[p][c] - first[c]) * axis[c];
    const double at = length > 0 ? std::clamp(along / length, 0.0, 1.0) : 0;
    const int guess = int(at * 15 + 0.5);
    // Weights are not quite evenly spaced, and points are rounded: a neighbour of the guess may be nearer.
    int best = std::numeric_limits<int>::max();
    for (int index = std::max(0, guess - 1); index <= std::min(15, guess + 1); ++index)
      if (const int error = errorOf(pixels[p], trial, index); error < best) {
        best = error;
        trial.indices[p] = index;
      }
    trial.error += best;
  }
  return trial;
}

Colour quantise(const std::array<double, 4>& colour, int pBit) noexcept {
  Colour result;
  for (std::size_t c = 0; c < 4; ++c)
    result[c] = 2 * std::clamp(int(std::lround((colour[c] - pBit) / 2)), 0, 127) + pBit;
  return result;
}

Trial bestPBits(const BlockPixels& pixels, const AxisEnds<4>& ends) noexcept {
  Trial best;
  for (int p = 0; p < 4; ++p) {
    const Trial trial = choose(pixels, quantise(ends.low, p & 1), quantise(ends.high, p >> 1));
    if (trial.error < best.error) best = trial;
  }
  return best;
}

// Least squares for given indices; returns false if all pixels have the same index.
bool solve(const BlockPixels& pixels, const Trial& trial, AxisEnds<4>& ends) noexcept {
  double aa = 0, ab = 0, bb = 0;
  std::array<double, 4> ax{}, bx{};
  for (std::size_t p = 0; p < pixels.size(); ++p) {
    const double b = kWeights[std::size_t(trial.indices[p])] / 64.0, a = 1 - b;
    aa += a * a;
    ab += a * b;
    bb += b * b;
    for (std::size_t c = 0; c < 4; ++c) {
      ax[c] += a * pixels[p][c];
      bx[c] += b * pixels[p][c];
    }
  }
  const double determinant = aa * bb - ab * ab;
  if (determinant < 1e-6) return false;
  for (std::size_t c = 0; c < 4; ++c) {
    ends.low[c] = std::clamp((ax[c] * bb - bx[c] * ab) / determinant, 0.0, 255.0);
    ends.high[c] = std::clamp((bx[c] * aa - ax[c] * ab) / determinant, 0.0, 255.0);
  }
  return true;
}

// Endpoints of a block of one colour. With different p-bits and an index in the middle of the line, both even and odd
// values are exact.
struct FlatTable {
  struct Pair {
    int first = 0, second = 0, error = 0;
  };
  struct PBitCase {
    int firstBit, secondBit, index;
    std::array<Pair, 256> pairs;
  };
  std::array<PBitCase, 4> cases{{{0, 0, 0, {}}, {1, 1, 0, {}}, {0, 1, 7, {}}, {1, 0, 7, {}}}};

  FlatTable() {
    for (PBitCase& pCase : cases)
      for (int value = 0; value < 256; ++value) {
        int best = std::numeric_limits<int>::max();
        for (int first = std::max(0, value - 4); first <= std::min(255, value + 4); ++first)
          for (int second = std::max(0, value - 4); second <= std::min(255, value + 4); ++second) {
            if ((first & 1) != pCase.firstBit || (second & 1) != pCase.secondBit) continue;
            const int d = between(first, second, kWeights[std::size_t(pCase.index)]) - value;
            if (d * d >= best) continue;
            best = d * d;
            pCase.pairs[std::size_t(value)] = {first, second, best};
          }
      }
  }
};

Trial flat(const std::array<std::uint8_t, 4>& colour) noexcept {
  static const FlatTable kTable;
  Trial best;
  for (const FlatTable::PBitCase& pCase : kTable.cases) {
    Trial trial;
    trial.error = 0;
    trial.indices.fill(pCase.index);
    for (std::size_t c = 0; c < 4; ++c) {
      const FlatTable::Pair& pair = pCase.pairs[colour[c]];
      trial.first[c] = pair.first;
      trial.second[c] = pair.second;
      trial.error += 16 * pair.error;
    }
    if (trial.error < best.error) best = trial;
  }
  return best;
}

// Writes up to 128 bits, the lowest first.
class Bits {
 public:
  void put(int value, int count) noexcept {
    for (int i = 0; i < count; ++i, ++at_)
      if (value >> i & 1) words_[at_ / 64] |= std::uint64_t(1) << at_ % 64;
  }
  int take(int count) noexcept {
    int value = 0;
    for (int i = 0; i < count; ++i, ++at_) value |= int(words_[at_ / 64] >> at_ % 64 & 1) << i;
    return value;
  }
  std::array<std::uint64_t, 2>& words() noexcept { return words_; }

 private:
  std::array<std::uint64_t, 2> words_{};
  std::size_t at_ = 0;
};

void write(Trial trial, std::span<std::byte, kBc7BlockBytes> block) noexcept {
  if (trial.indices[0] >= 8) {  // the highest bit is not stored
    std::swap(trial.first, trial.second);
    for (int& index : trial.indices) index = 15 - index;
  }
  Bits bits;
  bits.put(1 << 6, 7);
  for (std::size_t c = 0; c < 4; ++c) {
    bits.put(trial.first[c] >> 1, 7);
    bits.put(trial.second[c] >> 1, 7);
  }
  bits.put(trial.first[0] & 1, 1);
  bits.put(trial.second[0] & 1, 1);
  for (std::size_t p = 0; p < 16; ++p) bits.put(trial.indices[p], p == 0 ? 3 : 4);
  for (std::size_t i = 0; i < block.size(); ++i) block[i] = std::byte(bits.words()[i / 8] >> 8 * (i % 8));
}

}  // namespace

void encodeBc7(const BlockPixels& pixels, std::span<std::byte, kBc7BlockBytes> block) noexcept {
  if (std::all_of(pixels.begin(), pixels.end(), [&](const auto& pixel) { return pixel == pixels[0]; })) {
    write(flat(pixels[0]), block);
    return;
  }
  constexpr int kRounds = 4;
  AxisEnds<4> ends = principalEnds<4>(pixels);
  Trial best = bestPBits(pixels, ends);
  for (int round = 0; round < kRounds && best.error > 0 && solve(pixels, best, ends); ++round) {
    const Trial next = bestPBits(pixels, ends);
    if (next.error >= best.error) break;
    best = next;
  }
  write(best, block);
}

bool decodeBc7(std::span<const std::byte, kBc7BlockBytes> block, BlockPixels& pixels) noexcept {
  Bits bits;
  for (std::size_t i = 0; i < block.size(); ++i) bits.words()[i / 8] |= std::uint64_t(block[i]) << 8 * (i % 8);
  if (bits.take(7) != 1 << 6) return false;
  Colour first, second;
  for (std::size_t c = 0; c < 4; ++c) {
    first[c] = 2 * bits.take(7);
    second[c] = 2 * bits.take(7);
  }
  const int firstBit = bits.take(1), secondBit = bits.take(1);
  for (std::size_t p = 0; p < 16; ++p) {
    const int weight = kWeights[std::size_t(bits.take(p == 0 ? 3 : 4))];
    for (std::size_t c = 0; c < 4; ++c)
      pixels[p][c] = std::uint8_t(between(first[c] + firstBit, second[c] + secondBit, weight));
  }
  return true;
}

}  // namespace ibr
