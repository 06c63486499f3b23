// SPDX-License-Identifier: Apache-2.0
#include "author/mesh/label.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <vector>

using namespace ibr;

namespace {

constexpr int kSize = 64;

// Labels a triangle in two views; `change` makes the second view of the first one. The dense match is `offset` px away
// from the triangle's own position.
TriangleLabel labelOf(double amplitude, auto change, float offset = 0) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> noise(-1.0, 1.0);
  std::vector<MatchView> views(2);
  for (MatchView& view : views) view.picture = Image8(kSize, kSize, 3);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const double value = 120 + amplitude * noise(random), changed = change(value, noise(random));
      for (std::size_t c = 0; c < 3; ++c) {
        views[0].picture.pixel(x, y)[c] = std::uint8_t(std::lround(value));
        views[1].picture.pixel(x, y)[c] = std::uint8_t(std::lround(changed));
      }
    }
  DenseMatch match;
  match.good = Image8(kSize, kSize, 1, 1);
  match.position.assign(2, ImageF(kSize, kSize, 2));
  for (ImageF& position : match.position)
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        position.pixel(x, y)[0] = float(x) + 0.5f + offset;
        position.pixel(x, y)[1] = float(y) + 0.5f;
      }
  const std::vector<glm::vec2> corners{{8, 8}, {56, 8}, {8, 56}};
  const std::vector<std::vector<glm::vec2>> member{corners, corners};
  return labelTriangles(views, match, corners, member, std::vector<glm::uvec3>{{0, 1, 2}}).at(0);
}

}  // namespace

TEST_CASE("equal structure agrees under another exposure and slight noise") {
  const TriangleLabel same = labelOf(40, [](double value, double) { return value; });
  CHECK(same.ecc == Approx(1));
  CHECK(same.rms == Approx(0).margin(1e-3));
  CHECK(same.off == 0);
  CHECK(same.agrees());
  CHECK(labelOf(40, [](double value, double) { return 0.8 * value + 30; }).agrees());
  CHECK(labelOf(40, [](double value, double noise) { return value + 5 * noise; }).agrees());
  CHECK(labelOf(0, [](double value, double noise) { return value + 5 * noise; }).agrees());  // no texture to correlate
}

TEST_CASE("different structure does not agree, unless its contrast is too low to be visible") {
  const auto other = [](double amplitude) {
    return labelOf(amplitude, [=](double, double noise) { return 120 + amplitude * noise; });
  };
  CHECK(std::abs(other(40).ecc) < 0.2);
  CHECK_FALSE(other(40).agrees());
  CHECK(other(25).rms < 24);
  CHECK_FALSE(other(25).agrees());  // low RMS, but no correlation
  CHECK(other(10).ecc < 0.5);
  CHECK(other(10).agrees());
}

TEST_CASE("a mesh that is off the dense match does not agree where the shift is visible") {
  const auto same = [](double value, double) { return value; };
  for (const double amplitude : {60.0, 5.0}) {
    CHECK(labelOf(amplitude, same, 1.0f).off == 0);
    const TriangleLabel moved = labelOf(amplitude, same, 2.9f);
    CHECK(moved.ecc == Approx(1));
    CHECK(moved.off == 0);                                 // invisible: samples have equal colours in both views
    CHECK_FALSE(labelOf(amplitude, same, 3.1f).agrees());  // the shift is visible from other positions
  }
  const auto noisy = [](double value, double noise) { return value + 30 * noise; };
  CHECK(labelOf(60, noisy).agrees());
  const TriangleLabel elsewhere = labelOf(60, noisy, 3.0f);
  CHECK(elsewhere.off > 0.3);
  CHECK_FALSE(elsewhere.agrees());
}
