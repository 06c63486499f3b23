// SPDX-License-Identifier: Apache-2.0
#include "batch/tradeoff/tradeoff_histogram.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/random.h"
#include "ibr/author/reference.h"

namespace ibr::app {
namespace {

using LevelHistogram = std::array<std::uint32_t, 256>;  // number of pixels by level
using LevelTable = std::array<std::uint8_t, 256>;

constexpr int kDraws = 8;
constexpr double kGain = 0.85, kGamma = 1.2;  // of the known colour change

LevelTable planted() {
  LevelTable table{};
  for (std::size_t i = 0; i < table.size(); ++i)
    table[i] = std::uint8_t(std::lround(255 * kGain * std::pow(double(i) / 255, kGamma)));
  return table;
}

// Histograms of the green channel of randomly chosen pixels, before and after the change.
struct Histograms {
  LevelHistogram plain{}, changed{};
};

Histograms counted(const Image8& photograph, const LevelTable& change, int samples, Random& random) {
  Histograms histograms;
  const double pixels = double(photograph.width) * photograph.height;
  for (int s = 0; s < samples; ++s) {
    const std::size_t at = std::min(std::size_t(random.uniform(0, pixels)), std::size_t(pixels) - 1);
    const std::uint8_t level = photograph.values[at * std::size_t(photograph.channels) + 1];
    ++histograms.plain[level];
    ++histograms.changed[change[level]];
  }
  return histograms;
}

double errorOf(const LevelTable& table, const LevelTable& truth, const LevelHistogram& all) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    sum += double(all[i]) * std::abs(int(table[i]) - int(truth[i]));
    count += double(all[i]);
  }
  return sum / count;
}

}  // namespace

std::vector<MapError> mapErrors(const Image8& photograph, std::uint64_t seed) {
  const LevelTable change = planted();
  LevelHistogram all{};
  const int pixels = photograph.width * photograph.height;
  for (std::size_t at = 0; at < std::size_t(pixels); ++at)
    ++all[photograph.values[at * std::size_t(photograph.channels) + 1]];
  Random random(seed);
  std::vector<MapError> errors;
  for (int decade = 10; decade <= pixels; decade *= 10)
    for (const int samples : {decade, 3 * decade}) {
      if (samples > pixels) break;
      MapError error{samples, 0, 0};
      for (int draw = 0; draw < kDraws; ++draw) {
        const Histograms one = counted(photograph, change, samples, random),
                         other = counted(photograph, change, samples, random);
        error.same += errorOf(colourTable(one.plain, one.changed), change, all) / kDraws;
        error.apart += errorOf(colourTable(one.plain, other.changed), change, all) / kDraws;
      }
      errors.push_back(error);
    }
  return errors;
}

}  // namespace ibr::app
