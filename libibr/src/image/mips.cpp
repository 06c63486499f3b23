// SPDX-License-Identifier: Apache-2.0
//
// Averages in linear light, although renderers here sample and blend display-encoded values. A level replaces the
// photograph of a camera with fewer pixels, and a camera adds up light. Averages of encoded values would darken fine
// bright detail (foliage against the sky, lattices) with distance by up to 28 % of the range. Colour stays linear in 16
// bits from level to level, so rounding does not add up; alpha is averaged unchanged.
#include "ibr/texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "base/check.h"
#include "base/srgb.h"

namespace ibr {
namespace {

using Linear = Image<std::uint16_t>;

struct Transfer {
  std::array<std::uint16_t, 256> decode;
  std::array<std::uint8_t, 65536> encode;

  Transfer() {
    for (int i = 0; i < 256; ++i) {
      decode[std::size_t(i)] = std::uint16_t(std::lround(srgbToLinear(i / 255.0) * 65535.0));
    }
    for (int i = 0; i < 65536; ++i) {
      encode[std::size_t(i)] = std::uint8_t(std::lround(linearToSrgb(i / 65535.0) * 255.0));
    }
  }
};

const Transfer& transfer() {
  static const Transfer kTransfer;
  return kTransfer;
}

// Weights of up to three neighbours from 2·i on; their sum is the same for all i.
struct Taps {
  int first, count;
  std::array<std::uint32_t, 3> weight;
};

// Output i of n covers a box of (2n + 1) / n of the 2n + 1 inputs: parts n − i, n, i + 1 in units of 1 / n.
Taps tapsOf(int size, int i) {
  const auto n = std::uint32_t(size / 2), at = std::uint32_t(i);
  if (size == 1) return {0, 1, {1, 0, 0}};
  if (size % 2 == 0) return {2 * i, 2, {1, 1, 0}};
  return {2 * i, 3, {n - at, n, at + 1}};
}

template <class T, class ToLinear>
Linear halved(const Image<T>& source, ToLinear toLinear) {
  Linear result(std::max(1, source.width / 2), std::max(1, source.height / 2), 4);
  std::vector<Taps> columns;
  for (int x = 0; x < result.width; ++x) columns.push_back(tapsOf(source.width, x));
  // Weights of an axis sum to at most 65537 and values are at most 65535, so sums stay below 2^48.
  std::vector<std::uint64_t> row(std::size_t(source.width) * 4);
  auto sumOf = [](const Taps& t) { return std::uint64_t(t.weight[0]) + t.weight[1] + t.weight[2]; };
  for (int y = 0; y < result.height; ++y) {
    const Taps rows = tapsOf(source.height, y);
    std::fill(row.begin(), row.end(), 0);
    for (int k = 0; k < rows.count; ++k) {
      const auto line = std::size_t(rows.first + k) * std::size_t(source.width) * std::size_t(source.channels);
      toLinear(&source.values[line], rows.weight[std::size_t(k)], row);
    }
    const std::uint64_t total = sumOf(rows) * sumOf(columns[0]);
    std::uint16_t* out = &result.values[std::size_t(y) * std::size_t(result.width) * 4];
    for (const Taps& t : columns) {
      const std::uint64_t* in = &row[std::size_t(t.first) * 4];
      for (std::size_t c = 0; c < 4; ++c, ++out) {
        std::uint64_t sum = total / 2;
        for (std::size_t k = 0; k < std::size_t(t.count); ++k) sum += t.weight[k] * in[4 * k + c];
        *out = std::uint16_t(total == 4 ? sum >> 2 : sum / total);
      }
    }
  }
  return result;
}

Linear halvedFromEncoded(const Image8& source) {
  const auto& decode = transfer().decode;
  const auto channels = std::size_t(source.channels);
  return halved(source, [&](const std::uint8_t* in, std::uint64_t weight, std::vector<std::uint64_t>& row) {
    for (std::size_t i = 0; i < row.size(); i += 4, in += channels) {
      for (std::size_t c = 0; c < 3; ++c) row[i + c] += weight * decode[in[c]];
      row[i + 3] += weight * (channels == 4 ? in[3] * 257u : 65535u);
    }
  });
}

Linear halvedFromLinear(const Linear& source) {
  return halved(source, [](const std::uint16_t* in, std::uint64_t weight, std::vector<std::uint64_t>& row) {
    for (std::size_t i = 0; i < row.size(); ++i) row[i] += weight * in[i];
  });
}

Image8 encoded(const Linear& linear) {
  const auto& encode = transfer().encode;
  Image8 result(linear.width, linear.height, 4);
  for (std::size_t i = 0; i < result.values.size(); i += 4) {
    for (std::size_t c = 0; c < 3; ++c) result.values[i + c] = encode[linear.values[i + c]];
    result.values[i + 3] = std::uint8_t((linear.values[i + 3] + 128u) / 257u);
  }
  return result;
}

Image8 withAlpha(const Image8& source) {
  if (source.channels == 4) return source;
  Image8 result(source.width, source.height, 4, 255);
  for (std::size_t in = 0, out = 0; in < source.values.size(); in += 3, out += 4)
    std::copy_n(&source.values[in], 3, &result.values[out]);
  return result;
}

}  // namespace

std::vector<Image8> buildMips(const Image8& image) {
  check(!image.empty() && (image.channels == 3 || image.channels == 4), ErrorCode::invalidInput,
        "mips: {}x{} with {} channels, not RGB or RGBA", image.width, image.height, image.channels);
  std::vector<Image8> levels{withAlpha(image)};
  if (image.width == 1 && image.height == 1) return levels;
  Linear linear = halvedFromEncoded(image);
  levels.push_back(encoded(linear));
  while (linear.width > 1 || linear.height > 1) {
    linear = halvedFromLinear(linear);
    levels.push_back(encoded(linear));
  }
  return levels;
}

}  // namespace ibr
