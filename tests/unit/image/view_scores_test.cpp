// SPDX-License-Identifier: Apache-2.0
#include "ibr/view_scores.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "formula_pictures.h"
#include "ibr/error.h"

using namespace ibr;

namespace {

constexpr int kSide = 48;  // px

Image8 truthOfTest() {
  return blocks(kSide, kSide, 4, 1);
}

// The truth with errors of two levels: tier 0 in the upper half, tier 2 in the left of the lower half, a black hole in
// its right.
Image8 predictionOfTest() {
  const Image8 truth = truthOfTest();
  Image8 prediction(kSide, kSide, 4);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const bool lower = y >= kSide / 2;
      if (lower && x >= kSide / 2) continue;
      const auto pixel = prediction.pixel(x, y);
      for (std::size_t c = 0; c < 3; ++c) pixel[c] = std::uint8_t(std::max(0, truth.pixel(x, y)[c] - 2));
      pixel[3] = std::uint8_t(lower ? 255 - 2 * 64 : 255);
    }
  return prediction;
}

// Mask of the upper half.
Image8 upperHalf() {
  Image8 mask(kSide, kSide, 1);
  std::fill_n(mask.values.begin(), kSide * kSide / 2, std::uint8_t(255));
  return mask;
}

}  // namespace

TEST_CASE("scores of a view count holes as black and leave them out of the covered scores") {
  const Image8 truth = truthOfTest(), prediction = predictionOfTest();
  const ViewScores scores = scoreView(prediction, truth);
  CHECK(scores.coverage == Approx(0.75));
  CHECK(scores.coverageTier0 == Approx(0.5));
  CHECK(scores.coverageTier2 == Approx(0.25));
  CHECK(tierShares(prediction)[1] == 0);
  CHECK(scores.psnr == psnr(prediction, truth));
  CHECK(scores.psnrCovered == psnr(prediction, truth, coverOf(prediction)));
  CHECK(scores.psnrCovered > scores.psnr + 10);
  CHECK(scores.psnrCovered == Approx(20 * std::log10(255 / 2.0)).margin(0.3));
  CHECK(scores.worstTile.x == 32);  // tiles of 32 px: the one with the largest share of the hole
  CHECK(scores.worstTile.y == 32);
  CHECK(std::isnan(scores.psnrGain));
  CHECK(std::isnan(scores.msSsim));  // the image is too small
}

TEST_CASE("pixels outside the mask change no score of a view") {
  const Image8 truth = truthOfTest(), used = upperHalf();
  Image8 prediction = predictionOfTest();
  const ViewScores scores = scoreView(prediction, truth, true, used);
  for (int y = kSide / 2; y < kSide; ++y)
    for (std::uint8_t& value : prediction.pixel(0, y).first(3)) value = std::uint8_t(255 - value);
  const ViewScores same = scoreView(prediction, truth, true, used);
  CHECK(scores.coverage == 1);
  CHECK(scores.psnr == same.psnr);
  CHECK(scores.ssim == same.ssim);
  CHECK(scores.flip == same.flip);
  CHECK(scores.psnrCoveredGain == same.psnrCoveredGain);
  CHECK(scores.psnr == scores.psnrCovered);
  CHECK(scores.worstTile.meanSquared == -1);
}

TEST_CASE("one gain for each channel removes a difference of exposure") {
  const Image8 truth = ramp(kSide, kSide, 1, 2, 30);
  Image8 darker = truth;
  for (std::uint8_t& value : darker.values) value = std::uint8_t(value * 0.8);
  Image8 all(kSide, kSide, 1, 255);
  CHECK(psnr(gainFitted(darker, truth, all), truth) > psnr(darker, truth) + 5);
  CHECK(gainFitted(truth, truth, all) == truth);
}

TEST_CASE("a view without pixels that count has no scores") {
  const ViewScores scores = scoreView(predictionOfTest(), truthOfTest(), true, Image8(kSide, kSide, 1, 0));
  CHECK(std::isnan(scores.psnr));
  CHECK(std::isnan(scores.coverage));
}

TEST_CASE("scores of a view refuse images of other sizes or channels") {
  const Image8 truth = truthOfTest();
  CHECK_THROWS_AS(scoreView(predictionOfTest(), blocks(kSide, kSide + 1, 4, 1)), Error);
  CHECK_THROWS_AS(scoreView(truth, truth), Error);  // no alpha
  CHECK_THROWS_AS(scoreView(predictionOfTest(), truth, false, Image8(kSide - 1, kSide, 1, 255)), Error);
  CHECK_THROWS_AS(scoreView(predictionOfTest(), truth, false, Image8(kSide, kSide, 3, 255)), Error);
}
