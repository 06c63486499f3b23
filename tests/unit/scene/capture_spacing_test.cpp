// SPDX-License-Identifier: Apache-2.0
#include "scene/capture_spacing.h"

#include <catch2/catch.hpp>
#include <initializer_list>

using namespace ibr;

TEST_CASE("the capture spacing is the median distance to the next capture site") {
  const auto spacing = [](std::vector<double> xs) {
    std::vector<Camera> cameras;
    for (const double x : xs) cameras.push_back(Camera{pinholeFromFov(64, 48, 1), {{x, 0, 0}, {1, 0, 0, 0}}});
    return captureSpacing(cameras);
  };
  CHECK(spacing({0, 0, 0, 1, 1, 2}) == Approx(1));
  CHECK(spacing({3, 3}) == 1);
  CHECK(spacing({5}) == 1);
}
