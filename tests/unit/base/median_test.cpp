// SPDX-License-Identifier: Apache-2.0
#include "base/median.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using ibr::median;

TEST_CASE("the median ignores order and NaN") {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();
  CHECK(median({3}) == 3);
  CHECK(median({5, 1, 3}) == 3);
  CHECK(median({4, 1, 3, 2}) == 3);
  CHECK(median({kNaN, 1, kNaN, 2, 9, kNaN}) == 2);
  CHECK(median({kInfinity, 1, kInfinity}) == kInfinity);
  CHECK(std::isnan(median({})));
  CHECK(std::isnan(median({kNaN, kNaN})));
}
