// SPDX-License-Identifier: Apache-2.0
#include "shared/report/rank.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using namespace ibr::app;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();
using Indices = std::vector<std::size_t>;
using Points = std::vector<glm::dvec2>;
using Values = std::vector<double>;

}  // namespace

TEST_CASE("Pareto front: points that no other point beats, by rising cost") {
  CHECK(paretoFront(Points{}).empty());
  CHECK(paretoFront(Points{{3, 1}}) == Indices{0});
  CHECK(paretoFront(Points{{3, 3}, {1, 1}, {2, 2}}) == Indices{1, 2, 0});
  CHECK(paretoFront(Points{{1, 3}, {2, 2}, {3, 1}}) == Indices{0});
  CHECK(paretoFront(Points{{1, 1}, {2, 5}, {3, 4}, {4, 6}, {5, 6}}) == Indices{0, 1, 3});
}

TEST_CASE("Pareto front: keeps the best of equal cost and the first of equal points, only finite ones") {
  CHECK(paretoFront(Points{{1, 1}, {1, 2}, {1, 0}}) == Indices{1});
  CHECK(paretoFront(Points{{1, 2}, {1, 2}}) == Indices{0});
  CHECK(paretoFront(Points{{2, 2}, {1, 2}}) == Indices{1});
  CHECK(paretoFront(Points{{kNan, 9}, {1, kNan}, {2, 1}, {0, kInf}, {-kInf, 2}}) == Indices{2});
}

TEST_CASE("Spearman: a rising relation is 1, a falling one -1") {
  CHECK(spearman(Values{1, 2, 3, 4}, Values{1, 10, 100, 1e9}) == 1.0);
  CHECK(spearman(Values{1, 2, 3, 4}, Values{0, -1, -50, -51}) == -1.0);
  CHECK(spearman(Values{1, 2}, Values{5, 7}) == 1.0);
  // 1 - 6 Σd² / (n (n² - 1)) with d = 0, 1, 1, 0, 0
  CHECK(spearman(Values{1, 2, 3, 4, 5}, Values{1, 3, 2, 4, 5}) == Approx(0.9));
}

TEST_CASE("Spearman: ties share the mean of their ranks") {
  // Ranks 1, 2.5, 2.5, 4 and 1, 2, 3, 4: sums of products 4.5 and 4.5, 5.
  CHECK(spearman(Values{1, 2, 2, 3}, Values{1, 2, 3, 4}) == Approx(4.5 / std::sqrt(4.5 * 5.0)));
  CHECK(spearman(Values{1, 2, 2, 3}, Values{4, 9, 9, 11}) == 1.0);
}

TEST_CASE("Spearman: NaN if nothing can be ranked, and pairs that are not finite are ignored") {
  CHECK(std::isnan(spearman(Values{}, Values{})));
  CHECK(std::isnan(spearman(Values{1}, Values{2})));
  CHECK(std::isnan(spearman(Values{1, 1, 1}, Values{1, 2, 3})));
  CHECK(std::isnan(spearman(Values{1, 2, 3}, Values{4, 4, 4})));
  CHECK(std::isnan(spearman(Values{1, kNan}, Values{1, 2})));
  CHECK(spearman(Values{1, kNan, 2, 3, 4}, Values{1, 9, 2, kInf, 3}) == 1.0);
}
