// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <random>

#include "image/bc1.h"
#include "image/bc7.h"

using namespace ibr;

namespace {

BlockPixels flatBlock(int r, int g, int b, int a = 255) {
  BlockPixels pixels;
  pixels.fill({std::uint8_t(r), std::uint8_t(g), std::uint8_t(b), std::uint8_t(a)});
  return pixels;
}

template <std::size_t N>
std::array<std::byte, N> hexBlock(const char* hex) {
  std::array<std::byte, N> block;
  for (std::size_t i = 0; i < N; ++i) block[i] = std::byte(std::stoi(std::string(hex + 2 * i, 2), nullptr, 16));
  return block;
}

struct Bc1 {
  static constexpr std::size_t kBytes = kBc1BlockBytes;
  static BlockPixels coded(const BlockPixels& pixels, std::array<std::byte, kBytes>& block) {
    encodeBc1(pixels, block);
    return decodeBc1(block);
  }
};
struct Bc7 {
  static constexpr std::size_t kBytes = kBc7BlockBytes;
  static BlockPixels coded(const BlockPixels& pixels, std::array<std::byte, kBytes>& block) {
    encodeBc7(pixels, block);
    BlockPixels result;
    REQUIRE(decodeBc7(block, result));
    return result;
  }
};

int worst(const BlockPixels& a, const BlockPixels& b, std::size_t channels) {
  int most = 0;
  for (std::size_t p = 0; p < 16; ++p)
    for (std::size_t c = 0; c < channels; ++c) most = std::max(most, std::abs(a[p][c] - b[p][c]));
  return most;
}

std::pair<int, int> endpoints(const std::array<std::byte, kBc1BlockBytes>& block) {
  return {int(block[0]) | int(block[1]) << 8, int(block[2]) | int(block[3]) << 8};
}

// Upper bound of the optimal error of a block with endpoints on a line of colours. Endpoints: corners of the
// colours' bounding box; each pixel takes the nearest of 4 or 16 points.
template <int Points>
double boxError(const BlockPixels& pixels) {
  std::array<double, 3> low{255, 255, 255}, high{};
  for (const auto& pixel : pixels)
    for (std::size_t c = 0; c < 3; ++c) {
      low[c] = std::min<double>(low[c], pixel[c]);
      high[c] = std::max<double>(high[c], pixel[c]);
    }
  double sum = 0;
  for (const auto& pixel : pixels) {
    double best = 1e9;
    for (int i = 0; i < Points; ++i) {
      double error = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const double d = low[c] + (high[c] - low[c]) * i / (Points - 1) - pixel[c];
        error += d * d;
      }
      best = std::min(best, error);
    }
    sum += best;
  }
  return sum;
}

double squares(const BlockPixels& a, const BlockPixels& b) {
  double sum = 0;
  for (std::size_t p = 0; p < 16; ++p)
    for (std::size_t c = 0; c < 3; ++c) sum += (a[p][c] - b[p][c]) * (a[p][c] - b[p][c]);
  return sum;
}

}  // namespace

TEST_CASE("BC1 blocks decode to colours computed by hand", "[N14]") {
  // 0xFFFF is white, 0x0000 black; the first row takes all four colours, the second row the same in reverse.
  const BlockPixels four =
      decodeBc1(hexBlock<8>("ffff0000"
                            "e41b00ff"));
  CHECK(four[0] == std::array<std::uint8_t, 4>{255, 255, 255, 255});
  CHECK(four[1] == std::array<std::uint8_t, 4>{0, 0, 0, 255});
  CHECK(four[2] == std::array<std::uint8_t, 4>{170, 170, 170, 255});
  CHECK(four[3] == std::array<std::uint8_t, 4>{85, 85, 85, 255});
  CHECK(four[4] == four[3]);
  CHECK(four[7] == four[0]);
  CHECK(four[8] == four[0]);
  CHECK(four[15] == four[3]);

  // 0x8410 is (16, 32, 16): 132, 130, 132. 0x0821 is (1, 1, 1): 8, 4, 8. Interpolated: (2·132 + 8 + 1) / 3 = 91, …
  const BlockPixels grey =
      decodeBc1(hexBlock<8>("10842108"
                            "e4000000"));
  CHECK(grey[0] == std::array<std::uint8_t, 4>{132, 130, 132, 255});
  CHECK(grey[1] == std::array<std::uint8_t, 4>{8, 4, 8, 255});
  CHECK(grey[2] == std::array<std::uint8_t, 4>{91, 88, 91, 255});
  CHECK(grey[3] == std::array<std::uint8_t, 4>{49, 46, 49, 255});

  // The first endpoint is not greater: three colours, and black.
  const BlockPixels three =
      decodeBc1(hexBlock<8>("0000ffff"
                            "e4000000"));
  CHECK(three[0] == std::array<std::uint8_t, 4>{0, 0, 0, 255});
  CHECK(three[1] == std::array<std::uint8_t, 4>{255, 255, 255, 255});
  CHECK(three[2] == std::array<std::uint8_t, 4>{128, 128, 128, 255});
  CHECK(three[3] == std::array<std::uint8_t, 4>{0, 0, 0, 255});
}

TEST_CASE("a BC7 block decodes to colours computed by hand", "[N14]") {
  // Mode 6, lowest bit first. R 0 → 127, G 127 → 0, B 64 → 64, A 127 → 127, p-bits 0 and 1; the index of pixel i is i
  // (pixel 0 has 3 bits).
  //   1000000 | 0000000 1111111 | 1111111 0000000 | 0000001 0000001 | 1111111 1111111 | 0 1 | 000 1000 0100 1100 …
  std::array<std::byte, 16> block{};
  std::size_t at = 0;
  const auto put = [&](int value, int count) {
    for (int i = 0; i < count; ++i, ++at)
      if (value >> i & 1) block[at / 8] |= std::byte(1 << at % 8);
  };
  put(64, 7);
  for (int v : {0, 127, 127, 0, 64, 64, 127, 127}) put(v, 7);
  put(0, 1);
  put(1, 1);
  for (int i = 0; i < 16; ++i) put(i, i == 0 ? 3 : 4);
  REQUIRE(at == 128);
  BlockPixels pixels;
  REQUIRE(decodeBc7(block, pixels));
  CHECK(pixels[0] == std::array<std::uint8_t, 4>{0, 254, 128, 254});
  CHECK(pixels[15] == std::array<std::uint8_t, 4>{255, 1, 129, 255});
  // Weight 4 of 64: 255·4 = 1020, + 32, / 64 = 16; 254·60 + 4 = 15244, + 32, / 64 = 238; 128 + (4 + 32) / 64 = 128.
  CHECK(pixels[1] == std::array<std::uint8_t, 4>{16, 238, 128, 254});
  // Weight 34: 255·34 = 8670 → 135; 254·30 + 34 = 7654 → 120; 128 + 66 / 64 = 129; 254 + 1 = 255.
  CHECK(pixels[8] == std::array<std::uint8_t, 4>{135, 120, 129, 255});

  for (int mode = 0; mode < 8; ++mode) {
    block[0] = std::byte(1 << mode);
    INFO(mode);
    CHECK(decodeBc7(block, pixels) == (mode == 6));
  }
  block[0] = std::byte(0);
  CHECK_FALSE(decodeBc7(block, pixels));
}

TEST_CASE("blocks of one colour are off by at most 2 levels in BC1 and 1 level in BC7", "[N14]") {
  std::array<std::byte, 8> bc1;
  std::array<std::byte, 16> bc7;
  std::mt19937 random(5);
  int worstBc1 = 0, worstBc7 = 0, inexactBc7 = 0;
  const auto tryColour = [&](int r, int g, int b) {
    const BlockPixels pixels = flatBlock(r, g, b);
    worstBc1 = std::max(worstBc1, worst(Bc1::coded(pixels, bc1), pixels, 3));
    REQUIRE(endpoints(bc1).first > endpoints(bc1).second);
    const int error = worst(Bc7::coded(pixels, bc7), pixels, 4);
    worstBc7 = std::max(worstBc7, error);
    const bool both = r == 0 || g == 0 || b == 0;  // alpha is 255
    inexactBc7 += error > 0 && !both;
  };
  for (int v = 0; v < 256; ++v) {
    tryColour(v, v, v);
    tryColour(v, 0, 0);
    tryColour(0, v, 255);
    tryColour(255, 128, v);
  }
  for (int i = 0; i < 4000; ++i) tryColour(int(random() & 255), int(random() & 255), int(random() & 255));
  CHECK(worstBc1 <= 2);
  CHECK(worstBc7 <= 1);
  CHECK(inexactBc7 == 0);
  for (int alpha = 0; alpha < 256; ++alpha) {
    const BlockPixels pixels = flatBlock(40, 90, 201, alpha);
    CHECK(worst(Bc7::coded(pixels, bc7), pixels, 4) == 0);
  }
}

TEST_CASE("any block is encoded deterministically, with an error below that of its colours' bounding box", "[N14]") {
  std::mt19937 random(7);
  std::array<std::byte, 8> bc1, bc1Again;
  std::array<std::byte, 16> bc7, bc7Again;
  double box4 = 0, box16 = 0, error1 = 0, error7 = 0;
  for (int i = 0; i < 3000; ++i) {
    // Noise of any strength, smooth ramps, dark to bright.
    const int noise = 1 << random() % 8, base = int(random() & 255), slope = int(random() % 17);
    BlockPixels pixels;
    for (int p = 0; p < 16; ++p)
      for (int c = 0; c < 4; ++c)
        pixels[std::size_t(p)][std::size_t(c)] =
            c == 3 ? 255
                   : std::uint8_t(std::clamp(base + slope * (p % 4 + c) + int(random() % unsigned(noise)), 0, 255));
    const BlockPixels from1 = Bc1::coded(pixels, bc1), from7 = Bc7::coded(pixels, bc7);
    REQUIRE(endpoints(bc1).first > endpoints(bc1).second);
    encodeBc1(pixels, bc1Again);
    encodeBc7(pixels, bc7Again);
    REQUIRE(bc1 == bc1Again);
    REQUIRE(bc7 == bc7Again);
    // Endpoint quantisation (5 bits, or 7 bits and a shared one) adds at most a quarter of the squared step per value.
    REQUIRE(squares(from1, pixels) <= boxError<4>(pixels) * 1.3 + 16 * 3 * 16);
    REQUIRE(squares(from7, pixels) <= boxError<16>(pixels) * 1.3 + 16 * 3);
    box4 += boxError<4>(pixels);
    box16 += boxError<16>(pixels);
    error1 += squares(from1, pixels);
    error7 += squares(from7, pixels);
  }
  CHECK(error1 < box4);
  CHECK(error7 < box16);
}

TEST_CASE("blocks of two colours are as exact as the endpoints") {
  std::mt19937 random(11);
  std::array<std::byte, 8> bc1;
  std::array<std::byte, 16> bc7;
  for (int i = 0; i < 500; ++i) {
    BlockPixels pixels = flatBlock(int(random() & 255), int(random() & 255), int(random() & 255));
    const BlockPixels other = flatBlock(int(random() & 255), int(random() & 255), int(random() & 255));
    for (std::size_t p = 0; p < 16; ++p)
      if (random() & 1) pixels[p] = other[p];
    CHECK(worst(Bc1::coded(pixels, bc1), pixels, 3) <= 4);  // half a step of 5 bits
    CHECK(worst(Bc7::coded(pixels, bc7), pixels, 4) <= 1);
  }
}
