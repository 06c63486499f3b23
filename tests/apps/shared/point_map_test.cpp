// SPDX-License-Identifier: Apache-2.0
#include "shared/camera/point_map.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>
#include <set>

using namespace ibr::app;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::vector<glm::dvec2> scattered(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(0, 1);
  std::vector<glm::dvec2> points(count);
  for (glm::dvec2& point : points) point = {any(random), any(random)};
  return points;
}

std::optional<std::size_t> nearestOfAll(const std::vector<glm::dvec2>& points, glm::dvec2 at, double reach) {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (const double distance = glm::distance(points[i], at); distance <= reach && (!best || distance < reach)) {
      reach = distance;
      best = i;
    }
  return best;
}

}  // namespace

TEST_CASE("a map of points finds the nearest one as the exhaustive search does") {
  std::vector<std::vector<glm::dvec2>> sets{{}, {{0.5, 0.5}}, std::vector<glm::dvec2>(100, glm::dvec2(0.25, 0.5))};
  sets.push_back(scattered(1000, 1));
  sets.push_back(scattered(50, 2));
  for (std::size_t i = 0; i < 25; ++i) sets.back().push_back(sets.back()[i]);
  sets.back()[3].y = kNaN;
  sets.emplace_back();
  for (int i = 0; i < 300; ++i) sets.back().emplace_back(0.5, i % 30 * 0.03);  // in a row, each ten times
  for (const auto& points : sets) {
    const PointMap map(points);
    REQUIRE(map.size() == points.size());
    for (const glm::dvec2 at : scattered(200, 3))
      for (const double reach : {0.03, 10.0}) REQUIRE(map.nearest(at, reach) == nearestOfAll(points, at, reach));
    for (std::size_t i = 0; i < points.size(); i += 7)
      REQUIRE(map.nearest(points[i], 0.01) == nearestOfAll(points, points[i], 0.01));
  }
  CHECK(!PointMap({{0, 0}}).nearest({kNaN, 0}, 10));
}

TEST_CASE("a map of points draws a bounded number of points, spread over all") {
  const PointMap few(scattered(kMaxMapMarks, 4));
  CHECK(few.drawn().size() == kMaxMapMarks);
  const std::vector<glm::dvec2> many = scattered(100000, 5);
  const PointMap map(many);
  CHECK(map.drawn().size() <= kMaxMapMarks);
  CHECK(map.drawn().size() > kMaxMapMarks / 2);
  CHECK(std::ranges::is_sorted(map.drawn()));
  for (const glm::dvec2 at : scattered(100, 6))
    CHECK(std::ranges::any_of(map.drawn(), [&](std::uint32_t i) { return glm::distance(many[i], at) < 0.05; }));

  std::vector<glm::dvec2> broken(10000, glm::dvec2(kNaN, 0));
  CHECK(thinned(broken, 100).empty());
  std::ranges::fill(broken, glm::dvec2(3, 4));
  CHECK(thinned(broken, 100) == std::vector<std::uint32_t>{0});
  broken[5000] = {1e300, 4};
  CHECK(thinned(broken, 100) == std::vector<std::uint32_t>{0, 5000});
  CHECK(thinned(broken, 1).size() == 1);
}

TEST_CASE("picking on a map compares few points, however many there are") {
  std::array<std::size_t, 2> compared{};
  for (std::size_t i = 0; i < 2; ++i) {
    const PointMap map(scattered(i == 0 ? 2000 : 200000, 7));
    for (const glm::dvec2 at : scattered(100, 8)) map.nearest(at, 0.1, &compared[i]);
  }
  CHECK(compared[1] < 3 * compared[0]);
  CHECK(compared[1] < 100 * 100);
}
