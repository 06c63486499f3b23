// SPDX-License-Identifier: Apache-2.0
#include "image/depth_texture.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <limits>

#include "ibr/error.h"
#include "ibr/texture.h"
#include "image/half_float.h"
#include "support/error_of.h"
#include "support/temporary_folder.h"

using namespace ibr;

namespace {

DepthMaps ramp(int width, int height) {
  DepthMaps maps{ImageF(width, height, 1), ImageF(width, height, 1)};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      maps.inverseDepth.pixel(x, y)[0] = float(0.02 * x + 0.3 * y);
      maps.consensus.pixel(x, y)[0] = float((x * 7 + y * 3) % 11) / 10;
    }
  return maps;
}

}  // namespace

TEST_CASE("half floats are rounded to the nearest, ties to even") {
  struct Expected {
    float value;
    std::uint16_t half;
  };
  for (const Expected& e : {Expected{0.0f, 0},
                            {1.0f, 0x3C00},
                            {-2.0f, 0xC000},
                            {65504.0f, 0x7BFF},
                            {65519.0f, 0x7BFF},
                            {65520.0f, 0x7C00},
                            {1e30f, 0x7C00},
                            {1 + 0x1p-11f, 0x3C00},  // halfway: to even
                            {1 + 0x1p-11f + 0x1p-20f, 0x3C01},
                            {1 + 3 * 0x1p-11f, 0x3C02},  // halfway: to even
                            {2 - 0x1p-12f, 0x4000},      // the carry raises the exponent
                            {0x1p-14f, 0x0400},
                            {0x1p-24f, 0x0001},
                            {0x1p-25f, 0x0000},
                            {0x1.8p-24f, 0x0002},
                            {0x1p-14f - 0x1p-26f, 0x0400}}) {
    INFO(e.value);
    CHECK(toHalf(e.value) == e.half);
  }
  CHECK(toHalf(std::numeric_limits<float>::infinity()) == 0x7C00);
  CHECK(std::isnan(fromHalf(toHalf(std::numeric_limits<float>::quiet_NaN()))));
  int wrong = 0;
  for (int half = 0; half < 0x10000; ++half)
    if ((half & 0x7FFF) <= 0x7C00 && toHalf(fromHalf(std::uint16_t(half))) != half) ++wrong;
  CHECK(wrong == 0);
}

TEST_CASE("a depth texel has the maximum inverse depth of its block and the consensus of that pixel") {
  const DepthMaps maps = ramp(10, 6);
  const DepthTexture made = depthTexture(maps, 20);  // two map pixels per texel
  CHECK(made.texture.format == TextureFormat::rg16f);
  REQUIRE(made.texture.levels.size() == 1);
  CHECK(depthTextureSize({10, 6}, 20) == glm::ivec2(5, 3));
  REQUIRE(made.texture.width == 5);
  REQUIRE(made.texture.height == 3);
  CHECK(made.scale == double(maps.inverseDepth.pixel(9, 5)[0]));
  const DepthMaps back = readDepthTexture(made.texture, made.scale);
  for (int v = 0; v < 3; ++v)
    for (int u = 0; u < 5; ++u) {
      INFO(u << " " << v);
      // Inverse depth grows to the right and downwards.
      const float rho = maps.inverseDepth.pixel(2 * u + 1, 2 * v + 1)[0],
                  consensus = maps.consensus.pixel(2 * u + 1, 2 * v + 1)[0];
      CHECK(std::abs(back.inverseDepth.pixel(u, v)[0] - rho) <= 0x1p-11 * made.scale);
      CHECK(std::abs(back.consensus.pixel(u, v)[0] - consensus) <= 0x1p-11);
    }
  CHECK(back.inverseDepth.pixel(4, 2)[0] == maps.inverseDepth.pixel(9, 5)[0]);
}

TEST_CASE("blocks cut by the border of a map use only pixels inside") {
  const DepthMaps maps = ramp(7, 5);
  const DepthTexture made = depthTexture(maps, 10);  // three map pixels per texel
  CHECK(depthBlockSide(7, 10) == 3);
  REQUIRE(made.texture.width == 3);
  REQUIRE(made.texture.height == 2);
  const DepthMaps back = readDepthTexture(made.texture, made.scale);
  CHECK(back.inverseDepth.pixel(2, 1)[0] == maps.inverseDepth.pixel(6, 4)[0]);
}

TEST_CASE("a small map keeps its size") {
  CHECK(depthTextureSize({512, 384}, 4000) == glm::ivec2(512, 384));
  CHECK(depthTextureSize({512, 384}, 1024) == glm::ivec2(256, 192));
  CHECK(depthTextureSize({400, 300}, 400) == glm::ivec2(100, 75));
  CHECK(depthTextureSize({1, 1}, 1) == glm::ivec2(1, 1));
}

TEST_CASE("depth at infinity has scale 1") {
  const DepthTexture made = depthTexture({ImageF(8, 8, 1, 0.0f), ImageF(8, 8, 1, 0.1f)}, 8);
  CHECK(made.scale == 1);
  const DepthMaps back = readDepthTexture(made.texture, made.scale);
  CHECK(back.inverseDepth.values == std::vector<float>(4, 0.0f));
  CHECK(back.consensus.values == std::vector<float>(4, fromHalf(toHalf(0.1f))));
}

TEST_CASE("a depth texture reads back unchanged from its file") {
  const test::TemporaryFolder folder;
  const DepthTexture made = depthTexture(ramp(33, 21), 66);
  writeKtx2(folder / "depth.ktx2", made.texture);
  CHECK(readKtx2(folder / "depth.ktx2") == made.texture);
}

TEST_CASE("faulty depth maps and textures are refused") {
  const auto refused = [](const DepthMaps& maps) {
    CHECK(test::errorOf([&] { depthTexture(maps, 8); }).code() == ErrorCode::invalidInput);
  };
  refused({});
  refused({ImageF(4, 4, 1, 1.0f), ImageF(4, 3, 1, 1.0f)});
  refused({ImageF(4, 4, 2, 1.0f), ImageF(4, 4, 1, 1.0f)});
  for (const float bad : {-0.5f, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    DepthMaps maps = ramp(4, 4);
    maps.inverseDepth.values[5] = bad;
    refused(maps);
    maps = ramp(4, 4);
    maps.consensus.values[5] = bad;
    refused(maps);
  }
  DepthMaps maps = ramp(4, 4);
  maps.consensus.values[5] = 1.5f;
  refused(maps);
  const DepthTexture good = depthTexture(ramp(8, 8), 16);
  const auto unread = [](const Texture& texture, double scale) {
    CHECK(test::errorOf([&] { readDepthTexture(texture, scale); }).code() == ErrorCode::invalidInput);
  };
  for (const double scale : {0.0, -1.0, std::nan(""), HUGE_VAL}) unread(good.texture, scale);
  Texture texture = good.texture;
  texture.format = TextureFormat::rgba8;
  unread(texture, 1);
  texture = good.texture;
  texture.levels.push_back(texture.levels[0]);
  unread(texture, 1);
  texture = good.texture;
  texture.levels[0].pop_back();
  unread(texture, 1);
  for (const std::uint16_t bad : {std::uint16_t(0x7E00), std::uint16_t(0x7C00), std::uint16_t(0xBC00)})
    for (const std::size_t at : {0, 2}) {
      texture = good.texture;
      std::memcpy(&texture.levels[0][at], &bad, sizeof bad);
      unread(texture, 1);
    }
}
