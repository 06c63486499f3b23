// SPDX-License-Identifier: Apache-2.0
// The ECC's sums and ranks are exact at every area. The paper's 32-bit counters and floats are not: these tests show
// why the library departs from [T] §3.6.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <limits>

#include "ecc_samples.h"
#include "ibr/error.h"

using namespace ibr;
using namespace ibr::test;

namespace {

__extension__ using Int128 = __int128;

constexpr std::size_t kMega = 1'000'000, kMost = std::size_t(1) << 24;

struct Wide {
  Int128 n = 0, x = 0, y = 0, xx = 0, yy = 0, xy = 0;
  void add(Int128 a, Int128 b) { ++n, x += a, y += b, xx += a * a, yy += b * b, xy += a * b; }
  bool equals(const EccMoments& s) const {
    return n == s.n && x == s.x && y == s.y && xx == s.xx && yy == s.yy && xy == s.xy;
  }
};

long double oracle(const std::vector<Wide>& sums, EccDefinition definition, int floor) {
  std::vector<Wide> parts = sums;
  if (definition == EccDefinition::concatenated) {
    Wide all;
    for (const Wide& s : sums) all.n += s.n, all.x += s.x, all.y += s.y, all.xx += s.xx, all.yy += s.yy, all.xy += s.xy;
    parts = {all};
    floor = 0;
  }
  long double covariance = 0, varianceX = 0, varianceY = 0;
  for (const Wide& s : parts) {
    const long double n = (long double)(s.n), added = floor * n;
    covariance += (long double)(s.n * s.xy - s.x * s.y) / n + added;
    varianceX += (long double)(s.n * s.xx - s.x * s.x) / n + added;
    varianceY += (long double)(s.n * s.yy - s.y * s.y) / n + added;
  }
  return varianceX > 0 && varianceY > 0 ? covariance / std::sqrt(varianceX * varianceY) : 0;
}

enum class Kind { saturated, checkerboard, noise };

struct Pattern {
  Kind kind = Kind::noise;
  double deviation = 2, mean = 200;
};

// Calls `sample(a, b)` for `area` pairs, which correlate by about 0.9 if the pattern is noise.
template <class Sample>
void fill(const Pattern& pattern, std::size_t area, std::uint64_t seed, const Sample& sample) {
  Noise noise(seed);
  for (std::size_t i = 0; i < area; ++i) {
    if (pattern.kind == Kind::saturated) {
      sample(255, 255);
    } else if (pattern.kind == Kind::checkerboard) {
      sample(i % 2 ? 255 : 0, i % 2 && i % 16 != 1 ? 255 : 0);
    } else {
      const double z = noise();
      sample(level(pattern.mean + pattern.deviation * z),
             level(pattern.mean + pattern.deviation * (0.9 * z + 0.436 * noise())));
    }
  }
}

std::vector<Pattern> patterns() {
  std::vector<Pattern> list{{Kind::saturated}, {Kind::checkerboard}};
  for (double mean : {6, 20, 128, 200, 250})
    for (double deviation : {1, 2, 3}) list.push_back({Kind::noise, deviation, mean});
  return list;
}

// Compares tiles of a target, merged in random order, with one pass of 128-bit sums.
void checkExact(const Pattern& pattern, std::size_t area, std::size_t channels, std::size_t targets) {
  std::mt19937 random(std::uint32_t(area + 7 * channels + targets));
  std::vector<EccMoments> sums;
  std::vector<Wide> wide;
  for (std::size_t k = 0; k < channels * targets; ++k) {
    const std::size_t tile = 1 + random() % std::max<std::size_t>(area / 3, 64);
    std::vector<EccMoments> tiles(area / tile + 1);
    Wide exact;
    std::size_t i = 0;
    fill(pattern, area, 100 * area + k, [&](int a, int b) {
      tiles[i++ / tile].add(a, b);
      exact.add(a, b);
    });
    std::shuffle(tiles.begin(), tiles.end(), random);
    EccMoments merged;
    for (const EccMoments& t : tiles) merged.merge(t);
    sums.push_back(merged);
    wide.push_back(exact);
    REQUIRE(exact.equals(merged));
  }
  for (const EccDefinition definition : {EccDefinition::channels, EccDefinition::concatenated})
    for (int floor : {0, 25}) {
      const Ecc result = ecc(sums, definition, floor);
      REQUIRE(result.value <= 1.0);
      REQUIRE(std::abs(result.value - double(area < 2 ? 0 : oracle(wide, definition, floor))) <= 1e-12);
    }
}

EccMoments times(EccMoments sums, int doublings) {
  for (int i = 0; i < doublings; ++i) sums.merge(EccMoments(sums));
  return sums;
}

// [T] §3.6: 32-bit counters, products shifted right as in eq. 9, eq. 8 in floats.
class PaperSums {
 public:
  PaperSums(std::size_t area, int channels, int targets, double largest = 255)
      : shift_(std::max(0, int(std::ceil(std::log2(largest * largest * channels * targets * double(area)))) - 32)) {}
  void add(std::uint32_t a, std::uint32_t b) {
    ++n_, x_ += a, y_ += b, xx_ += a * a >> shift_, yy_ += b * b >> shift_, xy_ += a * b >> shift_;
  }
  int shift() const { return shift_; }
  std::uint32_t squares() const { return xx_; }
  float value() const { return value(float(n_), float(x_), float(y_), scaled(xx_), scaled(yy_), scaled(xy_)); }
  static float value(float n, float x, float y, float xx, float yy, float xy) {
    return (n * xy - x * y) / std::sqrt((n * xx - x * x) * (n * yy - y * y));
  }

 private:
  float scaled(std::uint32_t sum) const { return std::ldexp(float(sum), shift_); }
  int shift_;
  std::uint32_t n_ = 0, x_ = 0, y_ = 0, xx_ = 0, yy_ = 0, xy_ = 0;
};

std::size_t best(const std::vector<std::vector<EccMoments>>& candidates, EccDefinition definition, int floor) {
  std::size_t found = 0;
  for (std::size_t i = 1; i < candidates.size(); ++i)
    if (eccGreater(candidates[i], candidates[found], definition, floor)) found = i;
  return found;
}

}  // namespace

TEST_CASE("sums are exact and the ECC is right at every area, in any order", "[N1][P7]") {
  for (const Pattern& pattern : patterns())
    for (std::size_t channels : {1, 3})
      for (std::size_t targets : {1, 2, 3})
        for (std::size_t area : {1, 2, 7'339, 7'340}) checkExact(pattern, area, channels, targets);
  for (const Pattern& pattern : patterns())
    for (std::size_t area : {22'017, 22'018, 66'051}) checkExact(pattern, area, 3, 1);
  for (const Pattern& pattern : {Pattern{Kind::saturated}, Pattern{Kind::checkerboard}, Pattern{Kind::noise, 1, 250}}) {
    checkExact(pattern, kMega, 3, 3);
    checkExact(pattern, kMost, 1, 1);
  }
}

TEST_CASE("values with eight fraction bits stay exact to 16.7 million pixels of three channels and targets", "[N1]") {
  for (const int a : {65280, 32767, -32768, -1})
    for (const int b : {65280, 255, -32768}) {
      EccMoments two;
      two.add(a, b);
      two.add(a / 2, b / 3);
      const EccMoments most = times(two, 23);
      Wide wide;
      wide.add(a, b), wide.add(a / 2, b / 3);
      const Int128 times = Int128(1) << 23;
      wide = {wide.n * times, wide.x * times, wide.y * times, wide.xx * times, wide.yy * times, wide.xy * times};
      REQUIRE(wide.equals(most));
      const std::vector<EccMoments> nine(9, most);
      for (const EccDefinition definition : {EccDefinition::channels, EccDefinition::concatenated})
        CHECK(std::abs(ecc(nine, definition, 25 * 65536).value -
                       double(oracle(std::vector<Wide>(9, wide), definition, 25 * 65536))) <= 1e-12);
    }
}

TEST_CASE("the best candidate is that of the oracle, ties go to the first", "[N1][T4]") {
  std::mt19937 random(3);
  for (int set = 0; set < 60; ++set) {
    const std::array<std::size_t, 3> areas{30 + random() % 400, 30 + random() % 400, 30 + random() % 400};
    std::vector<std::vector<EccMoments>> candidates(12);
    std::vector<std::vector<Wide>> wide(12);
    for (std::size_t m = 0; m < 11; ++m)
      for (std::size_t k = 0; k < 9; ++k) {
        EccMoments& sums = candidates[m].emplace_back();
        Wide& exact = wide[m].emplace_back();
        fill({Kind::noise, 3, 200}, areas[k / 3], random(), [&](int a, int b) {
          sums.add(256 * (a - 128), 256 * (b - 128));
          exact.add(256 * (a - 128), 256 * (b - 128));
        });
      }
    for (const EccDefinition definition : {EccDefinition::channels, EccDefinition::concatenated})
      for (int floor : {0, 25 * 65536}) {
        std::size_t expected = 0;
        for (std::size_t m = 1; m < 11; ++m)
          if (oracle(wide[m], definition, floor) > oracle(wide[expected], definition, floor)) expected = m;
        // The last candidate counts each sample of the best one twice, so their ECCs are equal.
        candidates[11] = candidates[expected];
        for (EccMoments& sums : candidates[11]) sums = times(sums, 1);
        REQUIRE(best(candidates, definition, floor) == expected);
        std::swap(candidates[11], candidates[0]);
        REQUIRE(best(candidates, definition, floor) == 0);
        std::swap(candidates[11], candidates[0]);
      }
  }
}

TEST_CASE("candidates are ranked exactly: below double precision, by sign, and without correlation", "[N1][T4]") {
  EccMoments four;
  for (const int a : {32767, 32767, -32767, -32767}) four.add(a, a);
  EccMoments same = times(four, 22), other = same;
  other.y -= 1, other.yy += 32766 * 32766 - 32767 * 32767, other.xy += 32767 * 32766 - 32767 * 32767;
  CHECK(ecc({&same, 1}).value == ecc({&other, 1}).value);
  CHECK(eccGreater({&same, 1}, {&other, 1}));
  CHECK_FALSE(eccGreater({&other, 1}, {&same, 1}));
  CHECK_FALSE(eccGreater({&same, 1}, {&same, 1}));

  const EccMoments up{4, 2, 2, 2, 2, 2}, little{4, 2, 2, 2, 2, 1}, down{4, 2, 2, 2, 2, 0}, less{5, 2, 3, 2, 3, 1};
  const EccMoments flat{4, 4, 4, 4, 4, 4}, single{1, 5, 5, 25, 25, 25};
  const auto greater = [](const EccMoments& a, const EccMoments& b) { return eccGreater({&a, 1}, {&b, 1}); };
  CHECK(ecc({&down, 1}).value == -1.0);
  CHECK(greater(up, little));
  CHECK(greater(little, down));
  CHECK_FALSE(greater(little, up));
  CHECK_FALSE(greater(down, up));
  CHECK(greater(less, down));  // -1/6 and -1
  CHECK_FALSE(greater(down, less));
  for (const EccMoments& none : {flat, single, EccMoments{}}) {
    CHECK(greater(down, none));
    CHECK_FALSE(greater(none, up));
    CHECK_FALSE(greater(none, down));
    CHECK_FALSE(greater(none, none));
  }
  const std::vector<EccMoments> four_counts{up, less, same, {7, 0, 0, 3, 3, 3}};
  CHECK_THROWS_AS(eccGreater(four_counts, four_counts), Error);
  CHECK_FALSE(eccGreater(four_counts, four_counts, EccDefinition::concatenated));
}

TEST_CASE("the paper's counters give a wrong ECC, because each product is shifted", "[N1][T1][T3]") {
  const auto both = [](std::size_t area) {
    PaperSums paper(area, 3, 1);
    EccMoments exact;
    fill({Kind::noise, 2, 200}, 3 * area, 5, [&](int a, int b) {
      paper.add(std::uint32_t(a), std::uint32_t(b));
      exact.add(a, b);
    });
    return std::pair(double(paper.value()), ecc({&exact, 1}).value);
  };
  const auto [unshifted, exact] = both(22'017);
  CHECK(std::abs(unshifted - exact) < 0.005);
  CHECK(std::abs(both(22'018).first - exact) > 0.03);
  CHECK(std::abs(both(100'000).first - exact) > 0.1);
  CHECK_FALSE(std::abs(both(kMega).first) <= 1.0);  // or NaN
  CHECK(both(kMega).second == Approx(exact).margin(0.002));

  PaperSums saturated(65'536, 1, 1, 256);
  for (int i = 0; i < 65'536; ++i) saturated.add(256, 256);
  CHECK(saturated.shift() == 0);
  CHECK(saturated.squares() == 0);  // 2³² overflows a 32-bit counter
}

TEST_CASE("the paper's floats select a wrong candidate", "[N1][T4]") {
  int wrong = 0;
  for (int set = 0; set < 20; ++set) {
    float bestFloat = -2;
    std::size_t picked = 0, expected = 0;
    long double bestExact = -2;
    std::vector<std::vector<EccMoments>> candidates(16);
    for (std::size_t m = 0; m < candidates.size(); ++m) {
      PaperSums paper(22'017, 3, 1);
      Wide wide;
      EccMoments& sums = candidates[m].emplace_back();
      fill({Kind::noise, 2, 200}, 3 * 22'017, 16 * std::uint64_t(set) + m, [&](int a, int b) {
        paper.add(std::uint32_t(a), std::uint32_t(b));
        wide.add(a, b);
        sums.add(a, b);
      });
      const long double value = oracle({wide}, EccDefinition::concatenated, 0);
      if (value > bestExact) bestExact = value, expected = m;
      if (paper.value() > bestFloat) bestFloat = paper.value(), picked = m;
    }
    wrong += picked != expected;
    REQUIRE(best(candidates, EccDefinition::concatenated, 0) == expected);
  }
  CHECK(wrong > 2);
}
