// SPDX-License-Identifier: Apache-2.0
// Properties of colour tables over random and extreme histograms.
#include "render/plan/colour_table.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <random>
#include <string>
#include <vector>

using namespace ibr;
using namespace ibr::shader;

namespace {

struct Pair {
  std::string kind;
  LevelHistogram reference{}, modify{};
};

std::uint32_t below(std::mt19937& random, std::uint32_t count) {
  return std::uint32_t(random() % count);
}

constexpr std::uint32_t kMethods[]{kMapNaive, kMapStrict, kMapPreserving};

// Two histograms of `count` pixels: a level of `modify` is `change` of that level in the reference.
template <class Change>
Pair pixels(std::mt19937& random, std::string kind, std::uint32_t count, int low, int high, Change change) {
  Pair pair{std::move(kind)};
  std::uniform_int_distribution<int> level(low, high);
  for (std::uint32_t i = 0; i < count; ++i) {
    const int m = level(random);
    ++pair.modify[std::size_t(m)];
    ++pair.reference[std::size_t(std::clamp(int(change(m)), 0, 255))];
  }
  return pair;
}

Pair randomPair(std::mt19937& random) {
  std::uniform_int_distribution<int> any(0, 255);
  const auto same = [](int m) { return m; };
  Pair pair;
  switch (random() % 10) {
    case 0:
      return pixels(random, "one sample", 1, 0, 255, [&](int) { return any(random); });
    case 1: {
      const int level = any(random);
      return pixels(random, "one level", 1 + below(random, 1000), level, level, [&](int) { return any(random); });
    }
    case 2: {
      pair.kind = "two spikes";
      const std::uint32_t a = 1 + below(random, 1000), b = 1 + below(random, 1000);
      pair.modify[std::size_t(any(random))] += a;
      pair.modify[std::size_t(any(random))] += b;
      pair.reference[std::size_t(any(random))] += a;
      pair.reference[std::size_t(any(random))] += b;
      return pair;
    }
    case 3:
      return {"empty"};
    case 4:
      return pixels(random, "full range", 2000, 0, 255, [&](int) { return any(random); });
    case 5:
      return pixels(random, "inverted", 500, 0, 255, [](int m) { return 255 - m; });
    case 6: {
      pair.kind = "powers of two";
      for (int k = 0; k < 24; ++k) {
        pair.modify[std::size_t(any(random))] += 1u << k;
        pair.reference[std::size_t(any(random))] += 1u << k;
      }
      return pair;
    }
    case 7: {
      pair.kind = "2^31";
      pair.modify[std::size_t(any(random))] += 1u << 31;
      pair.modify[std::size_t(any(random))] += (1u << 31) - 1;
      pair.reference[std::size_t(any(random))] += 1u << 31;
      pair.reference[std::size_t(any(random))] += (1u << 31) - 1;
      return pair;
    }
    case 8: {
      const int low = any(random), high = std::min(255, low + int(random() % 40));
      return pixels(random, "narrow", 300, low, high, same);
    }
    default: {
      const double gain = 0.3 + double(random() % 1000) / 400, offset = double(int(random() % 100) - 50);
      return pixels(random, "gain and offset", 800, 30, 220, [=](int m) { return gain * m + offset; });
    }
  }
}

// Evaluates the formulas directly, with loops and wide integers; shares no code with the tested tables.
int oracle(const Pair& pair, int i, std::uint32_t method) {
  using Wide = long long;
  std::array<Wide, 256> r{}, m{};
  Wide sumR = 0, sumM = 0;
  for (std::size_t g = 0; g < 256; ++g) r[g] = sumR += pair.reference[g], m[g] = sumM += pair.modify[g];
  const auto naive = [&](int level) {
    for (int j = 0; j < 256; ++j)
      if (m[std::size_t(level)] <= r[std::size_t(j)]) return j;
    return 255;
  };
  int bottom = 255, top = 255;
  for (int g = 255; g >= 0; --g) {
    if (m[std::size_t(g)] != 0) bottom = g;
    if (m[std::size_t(g)] == sumM) top = g;
  }
  const auto floorOf = [](Wide a, Wide b) { return Wide(std::floor((long double)a / (long double)b)); };
  const auto ceilOf = [](Wide a, Wide b) { return a / b + (a % b != 0); };
  if (method == kMapNaive || (bottom <= i && i <= top)) return naive(i);
  const Wide low = naive(bottom), high = naive(top);
  const Wide line = top == bottom ? i - bottom + low : floorOf((high - low) * (i - bottom), top - bottom) + low;
  const Wide strict = std::clamp<Wide>(line, 0, 255);
  if (method == kMapStrict) return int(strict);
  if (i < bottom) return int(std::max(strict, ceilOf(low * i, bottom)));
  return int(std::min(strict, ceilOf(high * (255 - top) + (255 - high) * (i - top), 255 - top)));
}

}  // namespace

TEST_CASE("tables of a hundred thousand histogram pairs are monotone and exact", "[N9]") {
  std::mt19937 random(9);
  for (int round = 0; round < 100'000; ++round) {
    const Pair pair = randomPair(random);
    const std::uint32_t method = kMethods[round % 3];
    const LevelTable table = levelTable(pair.reference, pair.modify, method, 1);
    const bool seen = std::accumulate(pair.modify.begin(), pair.modify.end(), 0ull) >= 2;
    bool monotone = true, right = true;
    for (std::size_t i = 0; i < 256; ++i) {
      monotone &= i == 0 || table[i - 1] <= table[i];
      // Checking whole tables is slow: some levels of every pair are checked, and every level in some pairs.
      if (seen && (i * 7 + std::size_t(round)) % 37 == 0) right &= table[i] == oracle(pair, int(i), method);
    }
    if (monotone && right) continue;
    FAIL_CHECK("round " << round << ", " << pair.kind << ", method " << method << ", monotone " << monotone);
  }
}

TEST_CASE("tables equal the formulas at every 8-bit level", "[N9][T16]") {
  std::mt19937 random(10);
  for (int round = 0; round < 300; ++round) {
    const Pair pair = randomPair(random);
    if (std::accumulate(pair.modify.begin(), pair.modify.end(), 0ull) < 2) continue;
    for (std::uint32_t method : kMethods) {
      const LevelTable table = levelTable(pair.reference, pair.modify, method, 1);
      for (int i = 0; i < 256; ++i) {
        INFO(pair.kind << ", method " << method << ", level " << i);
        REQUIRE(int(table[std::size_t(i)]) == oracle(pair, i, method));
      }
    }
  }
}

TEST_CASE("equal histograms keep occupied levels", "[N9]") {
  std::mt19937 random(11);
  for (int round = 0; round < 2000; ++round) {
    Pair pair = randomPair(random);
    for (std::uint32_t method : kMethods) {
      const LevelTable table = levelTable(pair.modify, pair.modify, method, 1);
      for (std::size_t i = 0; i < 256; ++i)
        if (pair.modify[i] != 0) REQUIRE(std::size_t(table[i]) == i);
    }
  }
}

TEST_CASE("tables are the identity below the minimum samples, and complete from twice that", "[N9]") {
  std::mt19937 random(12);
  for (std::uint32_t least : {1u, 2u, 100u, 256u, 1u << 20}) {
    for (int round = 0; round < 50; ++round) {
      Pair pair{"spikes"};
      const std::uint32_t samples = std::uint32_t(random() % (2 * least + 2));
      pair.modify[random() % 256] += samples;
      pair.reference[random() % 256] += samples;
      const LevelTable table = levelTable(pair.reference, pair.modify, kMapPreserving, least);
      const LevelTable whole = levelTable(pair.reference, pair.modify, kMapPreserving, samples > 1 ? samples / 2 : 1);
      INFO(samples << " of " << least);
      for (std::size_t i = 1; i < 256; ++i) REQUIRE(table[i - 1] <= table[i]);
      if (samples < least) REQUIRE(table == identityTable());
      if (samples >= 2 * least) REQUIRE(table == whole);
      for (std::size_t i = 0; i < 256; ++i) {
        REQUIRE(int(table[i]) >= std::min(int(i), int(whole[i])));
        REQUIRE(int(table[i]) <= std::max(int(i), int(whole[i])));
      }
    }
  }
  CHECK(levelTable({}, {}, kMapPreserving, 0) == identityTable());
}

TEST_CASE("the preserving method ends at the range's ends where the strict line would clip", "[N9]") {
  std::mt19937 random(13);
  for (int round = 0; round < 5000; ++round) {
    const Pair pair = randomPair(random);
    if (std::accumulate(pair.modify.begin(), pair.modify.end(), 0ull) < 2) continue;
    const LevelTable strict = levelTable(pair.reference, pair.modify, kMapStrict, 1);
    const LevelTable preserving = levelTable(pair.reference, pair.modify, kMapPreserving, 1);
    if (pair.modify[0] == 0 && strict[0] == 0) REQUIRE(int(preserving[0]) == 0);
    if (pair.modify[255] == 0 && strict[255] == 255) REQUIRE(int(preserving[255]) == 255);
  }
}

TEST_CASE("a planted change of exposure is undone", "[N9]") {
  std::mt19937 random(14);
  std::uniform_real_distribution<double> gammas(0.8, 1.25), gains(0.7, 1.4);
  for (int round = 0; round < 200; ++round) {
    const double gamma = gammas(random), gain = gains(random);
    const auto changed = [&](double level) {
      return std::clamp(std::lround(255 * gain * std::pow(level / 255, gamma)), 0l, 255l);
    };
    // Levels as the reference shows the scene, dark ones more often; the mapped cell shows them `changed`.
    std::normal_distribution<double> scene(110, 45);
    std::vector<int> before, after;
    Pair pair{"exposure"};
    for (int i = 0; i < 20'000; ++i) {
      const int r = std::clamp(int(std::lround(scene(random))), 0, 255), m = int(changed(r));
      ++pair.reference[std::size_t(r)];
      ++pair.modify[std::size_t(m)];
      if (m == 255) continue;  // clipped levels cannot be restored
      before.push_back(m);
      after.push_back(r);
    }
    for (std::uint32_t method : kMethods) {
      const LevelTable table = levelTable(pair.reference, pair.modify, method, 256);
      double sum = 0;
      for (std::size_t i = 0; i < before.size(); ++i) sum += std::abs(int(table[std::size_t(before[i])]) - after[i]);
      INFO("gamma " << gamma << ", gain " << gain << ", method " << method);
      REQUIRE(sum / double(before.size()) <= 1.5);
    }
  }
}

TEST_CASE("tables move towards their target, arrive exactly, and never faster than allowed") {
  std::mt19937 random(15);
  for (int round = 0; round < 20'000; ++round) {
    const std::uint32_t target = kFine * below(random, 256), share = 1 + below(random, kWhole),
                        step = 1 + below(random, 2000);
    std::uint32_t shown = below(random, 255 * kFine + 1);
    const std::uint32_t next = approach(shown, target, share, step);
    const auto way = std::int64_t(next) - shown;
    REQUIRE(std::uint64_t(std::abs(way)) <= step);
    REQUIRE(std::max(shown, target) >= next);
    REQUIRE(std::min(shown, target) <= next);
    if (shown != target) REQUIRE(way != 0);
    // The result increases with both arguments.
    if (shown < 255 * kFine) REQUIRE(approach(shown + 1, target, share, step) >= next);
    if (target < 255 * kFine) REQUIRE(approach(shown, target + kFine, share, step) >= next);
    REQUIRE(approach(shown, target, 0, step) == shown);
    REQUIRE(approach(shown, target, kWhole, 255 * kFine) == target);
  }
  std::uint32_t shown = 0;
  int frames = 0;
  for (; shown != 200 * kFine && frames < 10'000; ++frames) shown = approach(shown, 200 * kFine, kWhole / 100, ~0u);
  CHECK(shown == 200 * kFine);
}

TEST_CASE("the state of a pixel is read from alpha with a safety margin", "[N7][T14]") {
  for (int tier = 0; tier < 4; ++tier) {
    const float final = float(255 - 64 * tier) / 255;
    for (float error : {-15.4f, -1.0f, -0.5f, 0.0f, 0.5f}) {
      CHECK(pixelState(final + error / 255) == kPixelFinal);
      CHECK(pixelState(final - kPendingStep + error / 255) == kPixelPending);
    }
  }
  CHECK(pixelState(0.0f) == kPixelEmpty);
  CHECK(pixelState(15.4f / 255) == kPixelEmpty);
}

TEST_CASE("colours and packed entries are preserved through 8 bits") {
  for (std::uint32_t level = 0; level < 256; ++level) {
    CHECK(levelsOf(vec3(float(level) / 255.0f)) == uvec3(level));
    const std::uint32_t entry = packLevels(level, 255 - level, level / 2);
    CHECK(packedLevel(entry, 0) == level);
    CHECK(packedLevel(entry, 1) == 255 - level);
    CHECK(packedLevel(entry, 2) == level / 2);
  }
}

TEST_CASE("a range of one level continues with slope 1", "[N9][T15]") {
  for (int seen = 0; seen < 256; seen += 15)
    for (int meant = 0; meant < 256; meant += 17) {
      Pair pair{"one level"};
      pair.modify[std::size_t(seen)] = pair.reference[std::size_t(meant)] = 1000;
      const LevelTable table = levelTable(pair.reference, pair.modify, kMapStrict, 1);
      for (int i = 0; i < 256; ++i) REQUIRE(int(table[std::size_t(i)]) == std::clamp(i - seen + meant, 0, 255));
    }
}

TEST_CASE("histograms of the same pixels map exactly from any sample, other histograms only from many", "[N9][T17]") {
  std::mt19937 random(17);
  std::normal_distribution<double> scene(110, 45);
  const auto changed = [](int r) { return std::size_t(40 + r / 2); };  // darker and flatter: two levels become one
  const auto levelOf = [&] { return std::clamp(int(std::lround(scene(random))), 0, 255); };
  std::vector<double> errors;
  for (const int samples : {10, 1000, 100'000}) {
    double apart = 0;
    for (int round = 0; round < 20; ++round) {
      Pair same{"same"}, other{"other"};
      std::array<bool, 256> seen{};
      for (int i = 0; i < samples; ++i) {
        const int r = levelOf();
        seen[changed(r)] = true;
        ++same.reference[std::size_t(r)], ++same.modify[changed(r)];
        ++other.reference[std::size_t(levelOf())], ++other.modify[changed(r)];
      }
      const LevelTable exact = levelTable(same.reference, same.modify, kMapNaive, 1);
      const LevelTable noisy = levelTable(other.reference, other.modify, kMapNaive, 1);
      double sum = 0, levels = 0;
      for (int m = 40; m < 168; ++m) {
        if (!seen[std::size_t(m)]) continue;
        const int r = 2 * (m - 40);  // or r + 1, which became the same level
        REQUIRE((exact[std::size_t(m)] == r || exact[std::size_t(m)] == r + 1));
        sum += std::abs(noisy[std::size_t(m)] - (r + 0.5)), ++levels;
      }
      apart += sum / levels / 20;
    }
    errors.push_back(apart);
  }
  CAPTURE(errors);
  CHECK(errors[0] > 5);
  CHECK(errors[1] < errors[0] / 3);
  CHECK(errors[2] < errors[1] / 2);
}
