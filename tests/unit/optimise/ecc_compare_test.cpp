// SPDX-License-Identifier: Apache-2.0
// Comparison of two candidates with 256-bit products, against exact rationals.
#include <boost/multiprecision/cpp_int.hpp>
#include <catch2/catch.hpp>
#include <random>

#include "shared/ecc.h"

using namespace ibr::shader;
using Exact = boost::multiprecision::cpp_int;

namespace {

int exactOrder(const EccScore& a, const EccScore& b) {
  const auto signedSquare = [](std::int64_t c) { return c < 0 ? Exact(-(Exact(c) * c)) : Exact(Exact(c) * c); };
  const Exact left = signedSquare(a.covariance) * b.varianceX * b.varianceY;
  const Exact right = signedSquare(b.covariance) * a.varianceX * a.varianceY;
  return left > right ? 1 : left < right ? -1 : 0;
}

std::int64_t randomBits(std::mt19937_64& random, int bits) {
  return bits == 0 ? 0 : std::int64_t(random() >> (64 - bits));
}

}  // namespace

TEST_CASE("the order of scores is exact up to the largest sums", "[N1][T4][P7]") {
  std::mt19937_64 random(3);
  int equal = 0;
  for (int i = 0; i < 200000; ++i) {
    const auto score = [&] {
      const int bits = 1 + int(random() % 62);
      EccScore s{randomBits(random, int(random() % unsigned(bits + 1))), 1 + randomBits(random, bits),
                 1 + randomBits(random, bits)};
      if (random() % 2) s.covariance = -s.covariance;
      return s;
    };
    EccScore a = score(), b = random() % 4 ? score() : a;
    if (random() % 4 == 0) b.covariance += std::int64_t(random() % 3) - 1;  // minimal differences
    if (random() % 8 == 0 && b.varianceX < (std::int64_t(1) << 61)) {       // equal values from other numbers
      b = a;
      b.covariance /= 2, a.covariance = 2 * b.covariance;
      a.varianceX = a.varianceX / 4 * 4 + 4, b.varianceX = a.varianceX / 4;
    }
    const int order = exactOrder(a, b);
    equal += order == 0;
    REQUIRE(eccGreater(a, b) == (order > 0));
    REQUIRE(eccGreater(b, a) == (order < 0));
  }
  CHECK(equal > 10000);
}

TEST_CASE("an undefined ECC is less than any other and never replaces a position", "[N2][T5]") {
  const EccScore none{5, 0, 7}, poor{-3, 4, 4}, fair{3, 4, 4}, zero{0, 4, 4};
  CHECK_FALSE(eccGreater(none, poor));
  CHECK(eccGreater(poor, none));
  CHECK_FALSE(eccWins(none, none));
  CHECK_FALSE(eccWins(none, poor));
  CHECK_FALSE(eccWins(poor, none));
  CHECK_FALSE(eccWins(zero, none));
  CHECK(eccWins(fair, none));
  CHECK(eccWins(zero, poor));
}

TEST_CASE("centred sums equal the exact sums rounded up", "[N1]") {
  std::mt19937_64 random(4);
  for (int i = 0; i < 100000; ++i) {
    const std::int64_t n = 1 + randomBits(random, int(random() % 25));
    const auto sum = [&] { return std::int64_t(random() % std::uint64_t(65535 * n)) - 32767 * n; };
    const std::int64_t x = sum(), y = sum(), xy = std::int64_t(random() >> 8);
    const Exact scaled = Exact(xy) * n - Exact(x) * y;
    Exact expected = scaled / n;
    if (expected * n < scaled) ++expected;
    REQUIRE(Exact(eccCentred(xy, x, y, n)) == expected);
  }
}

TEST_CASE("square roots are rounded up") {
  std::mt19937_64 random(5);
  for (int i = 0; i < 20000; ++i) {
    const std::int64_t v = randomBits(random, int(random() % 51));
    const std::int64_t root = eccCeilSqrt(v);
    REQUIRE(root * root >= v);
    REQUIRE((root == 0 || (root - 1) * (root - 1) < v));
  }
}
