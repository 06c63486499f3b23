// SPDX-License-Identifier: Apache-2.0
// 64-bit scores, shared with shaders, against tuples of 128 bits and more (image/ecc_sums.h).
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <vector>

#include "image/ecc_sums.h"
#include "optimise/judge.h"

using namespace ibr;

namespace {

__extension__ using Int128 = __int128;

EccMoments tuple(const shader::EccScore& s) {
  return {2, 0, 0, s.varianceX, s.varianceY, s.covariance};
}

bool agree(const shader::EccScore& a, const shader::EccScore& b) {
  const EccMoments p = tuple(a), q = tuple(b);
  return shader::eccGreater(a, b) == eccGreater({&p, 1}, {&q, 1}) &&
         shader::eccGreater(b, a) == eccGreater({&q, 1}, {&p, 1});
}

// A star whose targets have these areas; sums in the shader's format and as tuples.
struct Star {
  Judgement judgement;
  std::vector<EccMoments> sums;

  Star(std::mt19937& random, const std::vector<int>& areas, double deviation, double likeness) {
    std::normal_distribution<double> noise(0, 256 * deviation);
    for (const int area : areas) {
      shader::EccTarget& t = judgement.targets[std::size_t(judgement.count++)];
      std::array<EccMoments, 3> channel;
      for (int i = 0; i < area; ++i) {
        std::array<std::int64_t, 3> x{}, y{};
        for (std::size_t c = 0; c < 3; ++c) {
          const double z = noise(random);
          x[c] = std::lround(256.0 * (30 * double(c) - 60) + z);
          y[c] = std::lround(256.0 * (20 * double(c) + 10) + likeness * z + (1 - likeness) * noise(random));
          channel[c].add(x[c], y[c]);
          t.xx += x[c] * x[c], t.yy += y[c] * y[c], t.xy += x[c] * y[c];
        }
        t.x0 += x[0], t.x1 += x[1], t.x2 += x[2], t.y0 += y[0], t.y1 += y[1], t.y2 += y[2];
        ++t.n;
      }
      sums.insert(sums.end(), channel.begin(), channel.end());
    }
  }
};

}  // namespace

TEST_CASE("scores compare like integers of unlimited size") {
  std::mt19937_64 random(2);
  const auto variance = [&] { return std::int64_t(random() >> (2 + random() % 62)); };
  for (int i = 0; i < 100'000; ++i) {
    shader::EccScore a{0, variance(), variance()}, b{0, variance(), variance()};
    const auto covariance = [&](const shader::EccScore& s) {
      const double most = std::sqrt(double(s.varianceX) * double(s.varianceY));
      return std::int64_t((double(random() % 2001) - 1000) / 1001 * most);
    };
    a.covariance = covariance(a);
    b.covariance = covariance(b);
    REQUIRE(agree(a, b));
    // Equal, and one apart.
    const auto times = std::int64_t(1 + random() % 1000);
    const auto small = [](std::int64_t v) { return v >> 12; };
    const shader::EccScore one{small(a.covariance), small(a.varianceX), small(a.varianceY)};
    if (Int128(one.varianceX) * times * times > (Int128(1) << 62)) continue;
    shader::EccScore same{one.covariance * times, one.varianceX * times * times, one.varianceY};
    REQUIRE_FALSE(shader::eccGreater(one, same));
    REQUIRE_FALSE(shader::eccGreater(same, one));
    same.covariance += 1;
    REQUIRE(agree(one, same));
  }
}

TEST_CASE("a star's score equals the ECC of its samples") {
  std::mt19937 random(3);
  for (const std::vector<int>& areas : {std::vector{400}, {300, 310}, {250, 90, 700}})
    for (const double deviation : {2.0, 20.0})
      for (const double likeness : {0.0, 0.5, 0.95})
        for (const int floor : {0, 25})
          for (const EccDefinition definition : {EccDefinition::channels, EccDefinition::concatenated}) {
            const Star star(random, areas, deviation, likeness);
            const double expected = ecc(star.sums, definition, std::int64_t(floor) * 65536).value;
            CHECK(eccOf(star.judgement.score(definition, floor)) == Approx(expected).margin(1e-7).epsilon(0));
          }
}
