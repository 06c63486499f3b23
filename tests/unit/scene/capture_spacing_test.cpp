// SPDX-License-Identifier: Apache-2.0
#include "scene/capture_spacing.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <initializer_list>
#include <limits>
#include <random>

#include "base/median.h"

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

TEST_CASE("the capture spacing is exactly that of comparing all pairs") {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int repeat = 0; repeat < 60; ++repeat) {
    const double scale = std::array{1.0, 1e-9, 1e9}[std::size_t(repeat % 3)];
    const glm::dvec3 offset = repeat % 4 == 3 ? glm::dvec3(3e8, -2e7, 1e9) : glm::dvec3(0.0);
    std::vector<Camera> cameras;
    for (int n = 0; n < 1 + 7 * repeat; ++n) {
      glm::dvec3 at(unit(random), repeat % 2 * unit(random), repeat % 5 ? unit(random) : 0);
      if (repeat % 6 == 5) at = glm::round(4.0 * at);  // on a grid: many at the same site
      if (n % 3 == 2) at += 1e-7 * unit(random);       // almost at the same site
      if (n % 4 == 3) at = (cameras[std::size_t(n) / 2].pose.position - offset) / scale + 1e-7 * unit(random);
      cameras.push_back({pinholeFromFov(64, 48, 1), {offset + scale * at, {1, 0, 0, 0}}});
    }
    double extent = 0;
    for (const Camera& camera : cameras)
      extent = std::max(extent, glm::distance(camera.pose.position, cameras[0].pose.position));
    std::vector<double> distances;
    for (const Camera& a : cameras) {
      double best = std::numeric_limits<double>::infinity();
      for (const Camera& b : cameras) {
        const double distance = glm::distance(a.pose.position, b.pose.position);
        if (distance > 1e-6 * extent) best = std::min(best, distance);
      }
      if (std::isfinite(best)) distances.push_back(best);
    }
    CHECK(captureSpacing(cameras) == (distances.empty() ? 1.0 : median(distances)));
  }
}
