// SPDX-License-Identifier: Apache-2.0
// Sums over rows of pixels: all implementations give bit-identical sums.
#include "optimise/row_sums.h"

#include <catch2/catch.hpp>
#include <random>

#include "optimise/texels.h"

using namespace ibr;

namespace {

Image8 randomPicture(std::mt19937& random, int contrast) {
  Image8 picture(97, 83, 3);
  for (auto& value : picture.values)
    value = contrast == 255 ? (random() % 2 ? 255 : 0) : std::uint8_t(128 + int(random() % 17) - 8);
  return picture;
}

RunSource randomRun(std::mt19937& random, const Texels& texels) {
  constexpr int kOne = 1 << shader::kEccRunBits;
  const auto within = [&](int most) { return int(random() % unsigned(2 * most + 1)) - most; };
  // At most 64 · 0.6 px from the middle in both directions.
  return {texels.at(48 + within(8), 41 + within(1)),
          texels.stride,
          int(random() % kOne),
          int(random() % kOne),
          within(kOne * 6 / 10),
          within(kOne * 6 / 10)};
}

bool equal(const shader::EccTarget& a, const shader::EccTarget& b) {
  return a.n == b.n && a.x0 == b.x0 && a.x1 == b.x1 && a.x2 == b.x2 && a.y0 == b.y0 && a.y1 == b.y1 && a.y2 == b.y2 &&
         a.xx == b.xx && a.yy == b.yy && a.xy == b.xy;
}

}  // namespace

TEST_CASE("the fastest run adder gives the sums of the portable run adder", "[N1]") {
  const int contrast = GENERATE(8, 255);
  std::mt19937 random(5);
  const Texels a = texelsOf(randomPicture(random, contrast)), b = texelsOf(randomPicture(random, contrast));
  const RunAdder& fastest = fastestRunAdder();
  shader::EccTarget portableSums{}, fastSums{};
  RunLanes unused, lanes;
  for (int run = 0; run < 20000; ++run) {  // enough runs to flush the lanes' accumulators
    const RunSource source = randomRun(random, a), target = randomRun(random, b);
    const int pixels = 1 + int(random() % shader::kEccRun);
    kPortableRunAdder.add(source, target, pixels, portableSums, unused);
    fastest.add(source, target, pixels, fastSums, lanes);
  }
  fastest.finish(fastSums, lanes);
  CHECK(portableSums.n > 600000);
  CHECK(equal(fastSums, portableSums));
}

TEST_CASE("sums of black and white images do not overflow", "[N1]") {
  const auto level = std::uint8_t(GENERATE(0, 255));
  const Texels texels = texelsOf(Image8(97, 83, 3, level));
  const RunSource run{texels.at(10, 10), texels.stride, 0, 0, 1 << shader::kEccRunBits, 0};
  const std::int64_t value = level == 0 ? -32767 : 127 * 256;
  for (const RunAdder* adder : {&kPortableRunAdder, &fastestRunAdder()}) {
    shader::EccTarget sums{};
    RunLanes lanes;
    constexpr int kRuns = 50000;
    for (int i = 0; i < kRuns; ++i) adder->add(run, run, 64, sums, lanes);
    adder->finish(sums, lanes);
    CHECK(sums.n == kRuns * 64);
    CHECK(sums.x1 == value * kRuns * 64);
    CHECK(sums.xx == 3 * value * value * kRuns * 64);
    CHECK(sums.xy == sums.yy);
  }
}
