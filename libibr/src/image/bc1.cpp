// SPDX-License-Identifier: Apache-2.0
//
// The endpoints start at the ends of the colours' principal axis. Then, until nothing improves:
//
//   pixels choose the nearest of the four colours,
//   the endpoints are solved by least squares for these choices, each channel by itself,
//   and neighbours on the 5:6:5 grid are tried, with the rounding of the decoder
#include "image/bc1.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "image/principal_axis.h"

namespace ibr {
namespace {

constexpr int kLevels[3]{32, 64, 32};

int expand(int value, int channel) noexcept {
  return channel == 1 ? value << 2 | value >> 4 : value << 3 | value >> 2;
}

// Colours of selectors 2 and 3, rounded to the nearest.
int between(int near, int far) noexcept {
  return (2 * near + far + 1) / 3;
}

using Levels = std::array<int, 3>;  // one endpoint, 5:6:5
using Selectors = std::array<int, 16>;

struct Endpoints {
  Levels first, second;
};

int packed(const Levels& levels) noexcept {
  return levels[0] << 11 | levels[1] << 5 | levels[2];
}

std::array<std::array<int, 3>, 4> palette(const Endpoints& ends) noexcept {
  std::array<std::array<int, 3>, 4> colours;
  for (int c = 0; c < 3; ++c) {
    const auto at = std::size_t(c);
    const int a = expand(ends.first[at], c), b = expand(ends.second[at], c);
    colours[0][at] = a;
    colours[1][at] = b;
    colours[2][at] = between(a, b);
    colours[3][at] = between(b, a);
  }
  return colours;
}

struct Trial {
  Endpoints ends{};
  Selectors selectors{};
  int error = std::numeric_limits<int>::max();  // sum of squares
};

Trial choose(const BlockPixels& pixels, const Endpoints& ends) noexcept {
  const auto colours = palette(ends);
  Trial trial{ends, {}, 0};
  for (std::size_t p = 0; p < pixels.size(); ++p) {
    int best = std::numeric_limits<int>::max();
    for (int s = 0; s < 4; ++s) {
      const auto& colour = colours[std::size_t(s)];
      const int r = pixels[p][0] - colour[0], g = pixels[p][1] - colour[1], b = pixels[p][2] - colour[2];
      const int error = r * r + g * g + b * b;
      if (error < best) {
        best = error;
        trial.selectors[p] = s;
      }
    }
    trial.error += best;
  }
  return trial;
}

// Endpoints of a block of one colour: the pair whose colour between is nearest. Among equals the closest pair is taken,
// since devices differ by a fraction of the distance. All pixels take selector 2.
struct FlatTable {
  struct Pair {
    int first = 0, second = 0;
  };
  std::array<std::array<Pair, 256>, 2> pairs;  // of 5 bits, of 6 bits

  FlatTable() {
    for (int channel = 0; channel < 2; ++channel)
      for (int value = 0; value < 256; ++value) {
        int best = std::numeric_limits<int>::max();
        for (int first = 0; first < kLevels[channel]; ++first)
          for (int second = 0; second < kLevels[channel]; ++second) {
            const int a = expand(first, channel), b = expand(second, channel);
            const int cost = 1000 * std::abs(between(a, b) - value) + std::abs(a - b);
            if (cost < best) {
              best = cost;
              pairs[std::size_t(channel)][std::size_t(value)] = {first, second};
            }
          }
      }
  }
};

Endpoints flatEndpoints(const std::array<int, 3>& colour) noexcept {
  static const FlatTable kTable;
  Endpoints ends{};
  for (std::size_t c = 0; c < 3; ++c) {
    const FlatTable::Pair pair = kTable.pairs[c == 1][std::size_t(colour[c])];
    ends.first[c] = pair.first;
    ends.second[c] = pair.second;
  }
  return ends;
}

Levels quantise(const std::array<double, 3>& colour) noexcept {
  Levels levels;
  for (std::size_t c = 0; c < 3; ++c)
    levels[c] = std::clamp(int(std::lround(colour[c] * (kLevels[c] - 1) / 255.0)), 0, kLevels[c] - 1);
  return levels;
}

// Best endpoints for given selectors, within the searched neighbourhood.
Endpoints solve(const BlockPixels& pixels, const Trial& trial) noexcept {
  constexpr std::array<double, 4> kWeight{1, 0, 2.0 / 3, 1.0 / 3};  // of the first endpoint
  std::array<int, 4> count{};
  std::array<std::array<int, 3>, 4> sum{};
  for (std::size_t p = 0; p < pixels.size(); ++p) {
    const auto s = std::size_t(trial.selectors[p]);
    ++count[s];
    for (std::size_t c = 0; c < 3; ++c) sum[s][c] += pixels[p][c];
  }
  double aa = 0, ab = 0, bb = 0;
  for (std::size_t s = 0; s < 4; ++s) {
    const double a = kWeight[s], b = 1 - a, n = count[s];
    aa += n * a * a;
    ab += n * a * b;
    bb += n * b * b;
  }
  const double determinant = aa * bb - ab * ab;
  if (determinant < 1e-6) return trial.ends;  // all pixels use one colour

  Endpoints ends{};
  for (std::size_t c = 0; c < 3; ++c) {
    double ax = 0, bx = 0;
    for (std::size_t s = 0; s < 4; ++s) {
      ax += kWeight[s] * sum[s][c];
      bx += (1 - kWeight[s]) * sum[s][c];
    }
    const double scale = (kLevels[c] - 1) / 255.0;
    const auto lower = [&](double value) { return int(std::floor(std::clamp(value, 0.0, 255.0) * scale)); };
    const int firstLow = lower((ax * bb - bx * ab) / determinant), secondLow = lower((bx * aa - ax * ab) / determinant);
    double best = std::numeric_limits<double>::max();
    for (int first = std::max(0, firstLow - 1); first <= std::min(firstLow + 2, kLevels[c] - 1); ++first)
      for (int second = std::max(0, secondLow - 1); second <= std::min(secondLow + 2, kLevels[c] - 1); ++second) {
        const int a = expand(first, int(c)), b = expand(second, int(c));
        const std::array<int, 4> colour{a, b, between(a, b), between(b, a)};
        // Σ (colour − pixel)² without the part that does not depend on the colour.
        double error = 0;
        for (std::size_t s = 0; s < 4; ++s) error += double(colour[s]) * (count[s] * colour[s] - 2 * sum[s][c]);
        if (error < best) {
          best = error;
          ends.first[c] = first;
          ends.second[c] = second;
        }
      }
  }
  return ends;
}

Trial refined(const BlockPixels& pixels, const Endpoints& start) noexcept {
  constexpr int kRounds = 8;
  Trial best = choose(pixels, start);
  for (int round = 0; round < kRounds && best.error > 0; ++round) {
    const Trial next = choose(pixels, solve(pixels, best));
    if (next.error >= best.error) break;
    best = next;
  }
  return best;
}

void write(Trial trial, std::span<std::byte, kBc1BlockBytes> block) noexcept {
  int first = packed(trial.ends.first), second = packed(trial.ends.second);
  if (first < second) {
    std::swap(first, second);
    for (int& s : trial.selectors) s ^= 1;  // 0 ↔ 1, 2 ↔ 3
  } else if (first == second) {
    // Equal endpoints would select three-colour mode: one endpoint is moved, and no pixel uses the moved one.
    const int used = second > 0 ? 0 : 1;
    used == 0 ? --second : ++first;
    trial.selectors.fill(used);
  }
  std::uint32_t bits = 0;
  for (std::size_t p = 0; p < 16; ++p) bits |= std::uint32_t(trial.selectors[p]) << 2 * p;
  const std::uint64_t all = std::uint64_t(first) | std::uint64_t(second) << 16 | std::uint64_t(bits) << 32;
  for (std::size_t i = 0; i < block.size(); ++i) block[i] = std::byte(all >> 8 * i);
}

}  // namespace

void encodeBc1(const BlockPixels& pixels, std::span<std::byte, kBc1BlockBytes> block) noexcept {
  std::array<int, 3> low{255, 255, 255}, high{}, sum{};
  for (const auto& pixel : pixels)
    for (std::size_t c = 0; c < 3; ++c) {
      low[c] = std::min<int>(low[c], pixel[c]);
      high[c] = std::max<int>(high[c], pixel[c]);
      sum[c] += pixel[c];
    }
  const int range = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
  constexpr int kNarrow = 12;  // 8-bit levels; about the distance between colours of 5 bits
  Trial best;
  if (range <= kNarrow)
    best = refined(pixels, flatEndpoints({(sum[0] + 8) / 16, (sum[1] + 8) / 16, (sum[2] + 8) / 16}));
  if (range > 0) {
    const AxisEnds<3> ends = principalEnds<3>(pixels);
    const Trial trial = refined(pixels, {quantise(ends.high), quantise(ends.low)});
    if (trial.error < best.error) best = trial;
  }
  write(best, block);
}

BlockPixels decodeBc1(std::span<const std::byte, kBc1BlockBytes> block) noexcept {
  std::uint64_t all = 0;
  for (std::size_t i = 0; i < block.size(); ++i) all |= std::uint64_t(block[i]) << 8 * i;
  const int first = int(all & 0xFFFF), second = int(all >> 16 & 0xFFFF);
  const auto unpacked = [](int value) { return Levels{value >> 11, value >> 5 & 63, value & 31}; };
  auto colours = palette({unpacked(first), unpacked(second)});
  if (first <= second)
    for (std::size_t c = 0; c < 3; ++c) {
      colours[2][c] = (colours[0][c] + colours[1][c] + 1) / 2;
      colours[3][c] = 0;
    }
  BlockPixels pixels;
  for (std::size_t p = 0; p < pixels.size(); ++p) {
    const auto& colour = colours[all >> (32 + 2 * p) & 3];
    pixels[p] = {std::uint8_t(colour[0]), std::uint8_t(colour[1]), std::uint8_t(colour[2]), 255};
  }
  return pixels;
}

}  // namespace ibr
