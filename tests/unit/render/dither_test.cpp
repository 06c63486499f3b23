// SPDX-License-Identifier: Apache-2.0
// Choice of a member by dithering, for extreme weights and random numbers.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <vector>

#include "image/blue_noise.h"
#include "shared/cell.h"

using ibr::shader::ditherMember;
using ibr::shader::kNoiseSize;
using ibr::shader::noiseFromRank;
using ibr::shader::vec4;

TEST_CASE("every member is chosen in proportion to its weight", "[N7]") {
  const auto ranks = ibr::blueNoise(kNoiseSize, 1);
  std::mt19937_64 random(1);
  std::exponential_distribution<float> exponential;
  std::vector<vec4> weights{
      {1, 0, 0, 0}, {0, 1, 0, 0}, {.25f, .25f, .25f, .25f}, {.5f, .5f, 0, 0}, {0, .999f, .001f, 0}};
  for (int members = 2; members <= 4; ++members)
    for (int repeat = 0; repeat < 50; ++repeat) {
      vec4 w(0);
      for (int i = 0; i < members; ++i) w[i] = exponential(random);
      weights.push_back(w / (w.x + w.y + w.z + w.w));
    }
  for (const vec4& w : weights) {
    int count[4] = {};
    for (std::uint16_t rank : ranks) ++count[ditherMember(w, noiseFromRank(rank))];
    for (int i = 0; i < 4; ++i) {
      CHECK(std::abs(float(count[i]) / float(ranks.size()) - w[i]) <= 1.0f / 256);
      if (w[i] == 0.0f) CHECK(count[i] == 0);
    }
  }
}

TEST_CASE("random numbers lie between 0 and 1, and rounding never chooses a missing member (T11)", "[N7][T11]") {
  CHECK(noiseFromRank(0) > 0.0f);
  CHECK(noiseFromRank(kNoiseSize * kNoiseSize - 1) < 1.0f);
  for (float r : {0.0f, 1.0f / 512, 255.0f / 256, std::nextafter(1.0f, 0.0f), 1.0f}) {
    CHECK(ditherMember({1, 0, 0, 0}, r) == 0);
    CHECK(ditherMember({0, 0, 1, 0}, r) == 2);
    CHECK(ditherMember({0.5f, 0.4999999f, 0, 0}, r) <= 1);
    CHECK(ditherMember({0.3333333f, 0.3333333f, 0.3333333f, 0}, r) <= 2);
  }
}
