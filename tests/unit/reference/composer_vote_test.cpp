// SPDX-License-Identifier: Apache-2.0
// Votes of single pixels, by hand.
#include "reference/composer_vote.h"

#include <catch2/catch.hpp>
#include <vector>

using namespace ibr;
using ibr::reference::Surfaces;
using ibr::reference::Vote;

namespace {

constexpr double kStep = 0.01;  // of which two, and a hundredth of ρ, are the tolerance

Surfaces voted(const std::vector<Vote>& votes, std::size_t layers = 2) {
  return reference::vote(votes, kStep, layers);
}

}  // namespace

TEST_CASE("the weight of a vote falls with the distance of its photograph") {
  CHECK(reference::voteWeight(1, 0.7, 0) == Approx(0.7 / 0.3));
  CHECK(reference::voteWeight(0.5, 1, 2) == Approx(0.5 / 4.3));
  CHECK(reference::voteWeight(0, 1, 2) == 0);
  CHECK(reference::toleranceOf(kStep, 1.5) == Approx(0.035));
}

TEST_CASE("no votes are no surface, one is its own") {
  CHECK(voted({}).count == 0);
  const Surfaces one = voted({{0.5, 2, 1, 0.45}});
  REQUIRE(one.count == 1);
  CHECK(one.surface[0].inverseDepth == 0.5);
  CHECK(one.surface[0].opacity == Approx(0.5));
  CHECK_FALSE(one.surface[0].completed);
  CHECK(one.margin == 1);
}

TEST_CASE("a surface is the mean of the votes around its peak, by weight and nearness") {
  // t = .03 at ρ = 1. The kernel of half a tolerance is .75.
  const Surfaces two = voted({{1, 2, 1, 0.9}, {1.015, 1, 1, 0.6}});
  REQUIRE(two.count == 1);
  const double other = 1 - 0.015 * 0.015 / (0.03 * 0.03);
  CHECK(two.surface[0].inverseDepth == Approx((2 * 1 + other * 1.015) / (2 + other)));
  CHECK(two.surface[0].opacity == Approx((2 * 0.9 + other * 0.6) / (2 + other) / 0.9));
  const double supportOfOther = 1 + 2 * (1 - 0.015 * 0.015 / (0.03015 * 0.03015));
  CHECK(two.margin == Approx((2 + other - supportOfOther) / (2 + other)));
}

TEST_CASE("peaks are surfaces from front to back, at most as many as are asked for") {
  const std::vector<Vote> votes{{0.2, 1, 1, 0.9}, {1, 1, 1, 0.36}, {0.6, 1, 1, 2}};
  const Surfaces both = voted(votes);
  REQUIRE(both.count == 2);
  CHECK(both.surface[0].inverseDepth == 1);
  CHECK(both.surface[0].opacity == Approx(0.4));
  CHECK(both.surface[1].inverseDepth == 0.6);
  CHECK(both.surface[1].opacity == 1);
  CHECK(voted(votes, 1).count == 1);
}

TEST_CASE("a peak of less than a twentieth of the largest support is none") {
  CHECK(voted({{0.2, 1, 1, 0.9}, {1, 0.049, 1, 0.9}}).count == 1);
  CHECK(voted({{0.2, 1, 1, 0.9}, {1, 0.051, 1, 0.9}}).count == 2);
}

TEST_CASE("equal supports: the lower candidate is the peak") {
  // At infinity all tolerances are .02.
  const std::vector<Vote> votes{{0, 1, 1, 0.9}, {0, 1, 0.06, 0.1}};
  const Surfaces tie = voted(votes);
  REQUIRE(tie.count == 1);
  CHECK(tie.margin == 0);
  // Three in a row, the outer two not within each other's tolerance: the middle wins, whatever the order.
  for (const auto& [a, b, c] : {std::array{0.0, 0.015, 0.03}, std::array{0.015, 0.0, 0.03}}) {
    const Surfaces row = voted({{a, 1, 1, 0.9}, {b, 1, 1, 0.9}, {c, 1, 1, 0.9}});
    REQUIRE(row.count == 1);
    CHECK(row.surface[0].inverseDepth == Approx(0.015));
  }
  // Two with the same distance and weight: each has the other's kernel; the peak stands at the first.
  const double nearer = 0.01, t = 0.02;
  const Surfaces first = voted({{0, 1, 1, 0.9}, {0, 1, 1, 0.9}, {nearer, 1e-9, 1, 0.9}});
  REQUIRE(first.count == 1);
  CHECK(first.surface[0].inverseDepth == Approx(1e-9 * (1 - nearer * nearer / (t * t)) * nearer / 2));
}

TEST_CASE("a surface is completed where most of its weight was completed") {
  CHECK(voted({{0.5, 1.01, 0.06, 0.1}, {0.5, 1, 1, 0.9}}).surface[0].completed);
  CHECK_FALSE(voted({{0.5, 0.99, 0.06, 0.1}, {0.5, 1, 1, 0.9}}).surface[0].completed);
  CHECK(voted({{0.5, 1, 0.154, 0.1}}).surface[0].completed);  // between no and one confirmation
  CHECK_FALSE(voted({{0.5, 1, 0.156, 0.1}}).surface[0].completed);
}

TEST_CASE("holes are filled from around by pull and push") {
  constexpr int kWidth = 5, kHeight = 3;
  const auto image = [](const std::vector<std::pair<int, double>>& known) {
    std::vector<Surfaces> pixels(kWidth * kHeight);
    for (const auto& [at, rho] : known) {
      pixels[std::size_t(at)].surface[0] = {rho, 0.7, false};
      pixels[std::size_t(at)].count = 1;
    }
    reference::fillHoles(pixels, kWidth, kHeight);
    return pixels;
  };
  for (const Surfaces& pixel : image({})) CHECK(pixel.count == 0);

  const std::vector<Surfaces> one = image({{7, 0.25}});
  for (std::size_t at = 0; at < one.size(); ++at) {
    REQUIRE(one[at].count == 1);
    CHECK(one[at].surface[0].inverseDepth == Approx(0.25));
    CHECK(one[at].filled == (at != 7));
    CHECK(one[at].surface[0].opacity == (at == 7 ? 0.7 : 1.0));
  }

  // Levels of 5 × 3, 3 × 2, 2 × 1, 1 × 1 px. Pixels 0 and 4 are known: at 3 × 2 its left and right upper ones weigh .5,
  // at 2 × 1 both .25 (shared/fill.h), and their mean of .4 is pushed down again.
  const std::vector<Surfaces> two = image({{0, 0.2}, {4, 0.6}});
  CHECK(two[0].surface[0].inverseDepth == 0.2);
  CHECK(two[4].surface[0].inverseDepth == 0.6);
  const double left = 0.75 * 0.4 + 0.25 * 0.2, right = 0.75 * 0.4 + 0.25 * 0.6;  // at 2 × 1
  const double first = 0.5 * left + 0.5 * 0.2, middle = 0.75 * left + 0.25 * right,
               last = 0.5 * (0.25 * left + 0.75 * right) + 0.5 * 0.6;  // at 3 × 2
  CHECK(two[1].surface[0].inverseDepth == Approx(0.75 * first + 0.25 * middle));
  CHECK(two[2].surface[0].inverseDepth == Approx(0.25 * first + 0.75 * middle));
  CHECK(two[3].surface[0].inverseDepth == Approx(0.75 * middle + 0.25 * last));
}
