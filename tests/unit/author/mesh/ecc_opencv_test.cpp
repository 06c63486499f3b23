// SPDX-License-Identifier: Apache-2.0
// Compares the ECC with OpenCV's cv::computeECC, which takes one channel of floats.
#include <catch2/catch.hpp>
#include <opencv2/core.hpp>
#include <opencv2/video/tracking.hpp>
#include <random>

#include "image/ecc_sums.h"

using namespace ibr;

TEST_CASE("the ECC of one channel equals OpenCV's", "[N2]") {
  std::mt19937 random(1);
  for (const auto& [mean, range, likeness] :
       {std::tuple{128, 100, 0.9}, std::tuple{128, 100, -0.4}, std::tuple{40, 30, 0.5}, std::tuple{200, 6, 0.99}}) {
    std::uniform_real_distribution<double> noise(-0.5 * range, 0.5 * range);
    cv::Mat a(37, 53, CV_32F), b(37, 53, CV_32F);
    EccMoments sums;
    for (int y = 0; y < a.rows; ++y)
      for (int x = 0; x < a.cols; ++x) {
        const double z = noise(random);
        const int p = int(mean + z), q = int(mean + likeness * z + (1 - std::abs(likeness)) * noise(random));
        a.at<float>(y, x) = float(p), b.at<float>(y, x) = float(q);
        sums.add(p, q);
      }
    for (const EccDefinition definition : {EccDefinition::channels, EccDefinition::concatenated})
      CHECK(ecc({&sums, 1}, definition).value == Approx(cv::computeECC(a, b)).margin(1e-6).epsilon(0));
  }
}
