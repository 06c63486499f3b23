// SPDX-License-Identifier: Apache-2.0
#include "batch/evaluate/depth_scores.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "ibr/scene.h"

using namespace ibr;
using namespace ibr::app;

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

ImageF row(std::vector<float> values) {
  ImageF image(int(values.size()), 1, 1);
  image.values = std::move(values);
  return image;
}

}  // namespace

TEST_CASE("depth is right within a pixel of parallax, and the sky does not count") {
  // 100 px · 0.5 units: one px of parallax is 0.02 of inverse depth.
  const DepthScores scores = depthScores(row({0.5f, 0.519f, 0.53f, 0.47f, -1, 3}), row({2, 2, 2, 2, 2, 0}), {100, 0.5});
  CHECK(scores.right == Approx(2.0 / 5));
  CHECK(scores.tooNear == Approx(1.0 / 5));
  CHECK(scores.tooFar == Approx(1.0 / 5));
  CHECK(depthScores(row({0}), row({2}), {100, 0.5}).tooFar == 1);
  CHECK(std::isnan(depthScores(row({1}), row({0}), {100, 0.5}).right));
}

TEST_CASE("completed, filled and empty pixels are guessed; matched ones are not") {
  FrameBuffers buffers{ImageF(6, 1, 4), ImageF(6, 1, 4), ImageF(6, 1, 2)};
  const auto set = [&](int x, float depth, float tier, float uncertainty) {
    buffers.surface.pixel(x, 0)[0] = depth;
    buffers.surface.pixel(x, 0)[1] = tier;
    buffers.confidence.pixel(x, 0)[1] = uncertainty;
  };
  set(0, 4, kTierConsistent, 0.001f);
  set(1, 4, kTierConsistent, 0.2f);
  set(2, 4, kTierCompleted, 1.0f / 4);
  set(3, 4, kTierCompleted, 1.0f / 4);
  set(4, kInfinity, kTierFilled, kInfinity);
  set(5, kInfinity, -1, kInfinity);
  CHECK(guessedShare(buffers) == Approx(4.0 / 6));
  const ImageF drawn = drawnInverseDepth(buffers);
  CHECK(drawn.values[0] == 0.25f);
  CHECK(drawn.values[4] < 0);
  CHECK(drawn.values[5] < 0);
}

TEST_CASE("deviation scores are shares of confirmed pixels within one and two standard deviations") {
  FrameBuffers buffers{ImageF(6, 1, 4), ImageF(6, 1, 4), ImageF(6, 1, 2)};
  const auto set = [&](int x, float depth, float tier, float deviation) {
    buffers.surface.pixel(x, 0)[0] = depth;
    buffers.surface.pixel(x, 0)[1] = tier;
    buffers.confidence.pixel(x, 0)[1] = deviation;
  };
  const ImageF truth = row({4, 4, 4, 4, 0, 4});
  set(0, 4, kTierConsistent, 0);              // exact
  set(1, 1 / 0.26f, kTierConsistent, 0.02f);  // error of half a standard deviation
  set(2, 1 / 0.28f, kTierConsistent, 0.02f);  // error of 1.5 standard deviations
  set(3, kInfinity, kTierConsistent, 0.1f);   // error of 2.5 standard deviations
  set(4, 4, kTierConsistent, 1);              // sky in the truth
  set(5, 4, kTierCompleted, 1);               // unconfirmed depth
  CHECK(deviationScores(buffers, truth).one == Approx(2.0 / 4));
  CHECK(deviationScores(buffers, truth).two == Approx(3.0 / 4));
  set(0, kInfinity, -1, kInfinity);
  CHECK(deviationScores(buffers, truth).one == Approx(1.0 / 3));
  CHECK(std::isnan(deviationScores(buffers, row({0, 0, 0, 0, 0, 0})).one));
}
