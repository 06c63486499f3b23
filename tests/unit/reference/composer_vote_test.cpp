// SPDX-License-Identifier: Apache-2.0
// Votes of single pixels against values computed by hand.
#include "reference/composer_vote.h"

#include <catch2/catch.hpp>
#include <utility>
#include <vector>

using namespace ibr;
using ibr::reference::Surfaces;
using ibr::reference::Vote;

namespace {

constexpr double kStep = 0.01;  // the tolerance is two steps plus a hundredth of ρ

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

TEST_CASE("no votes give no surface, and one vote gives its own surface") {
  CHECK(voted({}).count == 0);
  const Surfaces one = voted({{0.5, 2, 1, 0.45}});
  REQUIRE(one.count == 1);
  CHECK(one.surface[0].inverseDepth == 0.5);
  CHECK(one.surface[0].opacity == 1);
  CHECK_FALSE(one.surface[0].completed);
  CHECK(one.margin == 1);
}

TEST_CASE("uncertainty of a surface falls with its consensus, from a tenth of its depth") {
  for (const auto& [consensus, uncertainty] :
       {std::pair{0.0, 0.1}, {0.1, 0.08}, {0.25, 0.05}, {0.5, 0.0}, {1.0, 0.0}}) {
    CAPTURE(consensus);
    CHECK(voted({{0.5, 2, 1, consensus}}).surface[0].uncertainty == Approx(uncertainty).margin(1e-12));
  }
  CHECK(voted({{1, 3, 1, 0.4}, {1, 1, 1, 0}}).surface[0].uncertainty == Approx(0.1 * (1 - 0.3 / 0.5)));
}

TEST_CASE("a surface is the mean of the votes around its peak, by weight and nearness") {
  // t = .03 at ρ = 1. The kernel at half a tolerance is .75.
  const Surfaces two = voted({{1, 2, 1, 0.9}, {1.015, 1, 1, 0.6}});
  REQUIRE(two.count == 1);
  const double other = 1 - 0.015 * 0.015 / (0.03 * 0.03);
  CHECK(two.surface[0].inverseDepth == Approx((2 * 1 + other * 1.015) / (2 + other)));
  const double supportOfOther = 1 + 2 * (1 - 0.015 * 0.015 / (0.03015 * 0.03015));
  CHECK(two.margin == Approx((2 + other - supportOfOther) / (2 + other)));
}

TEST_CASE("surfaces are ordered front to back, with opacity by their share of the visible") {
  // Presences 1, 1 and 1 of equal support; from front to back they show .4, .6 · .5 and .6 · .5.
  const std::vector<Vote> votes{{0.2, 1, 1, 0.9}, {1, 1, 1, 0.36}, {0.6, 1, 1, 0.45}};
  const Surfaces both = voted(votes);
  REQUIRE(both.count == 2);
  CHECK(both.surface[0].inverseDepth == 1);
  CHECK(both.surface[0].opacity == Approx(0.4 / 0.7));
  CHECK(both.surface[1].inverseDepth == 0.6);
  CHECK(both.surface[1].opacity == 1);
  CHECK(both.margin == Approx(0).margin(1e-12));
  const Surfaces one = voted(votes, 1);
  REQUIRE(one.count == 1);
  CHECK(one.surface[0].inverseDepth == 1);
  CHECK(one.surface[0].opacity == 1);
}

TEST_CASE("surfaces with the largest visible shares are chosen at any depth") {
  // Front to back: consensus .018 shows .02, a support of a hundredth shows .98 · .01; the last two share the rest.
  const std::vector<Vote> votes{{1, 1, 1, 0.018}, {0.8, 0.01, 1, 0.9}, {0.6, 1, 1, 0.54}, {0.2, 1, 1, 0.09}};
  const Surfaces both = voted(votes);
  REQUIRE(both.count == 2);
  CHECK(both.surface[0].inverseDepth == 0.6);
  CHECK(both.surface[0].opacity == Approx(0.6));
  CHECK(both.surface[1].inverseDepth == 0.2);
  CHECK(both.margin == 0);
  // A tenth of the last surface is missing, so the surface before shows that much more.
  const Surfaces less = voted({votes[0], votes[1], votes[2], {0.2, 0.9, 1, 0.09}});
  CHECK(less.surface[0].opacity == Approx(0.64 / (0.64 + 0.36 * 0.9)));
}

TEST_CASE("the margin is that of the closest decision") {
  // Presences 1, 2/3 and 1/3; they show 11/18, then 7/18 · 2/3 · 5/6, then a third of the rest.
  const Surfaces three = voted({{1, 3, 1, 0.45}, {0.6, 2, 1, 0.45}, {0.2, 1, 1, 0.9}});
  const double second = 7 / 18.0 * 2 / 3 * 5 / 6, third = (7 / 18.0 - second) / 3;
  CHECK(three.margin == Approx(second - third));
  CHECK(three.surface[0].opacity == Approx(11 / 18.0 / (11 / 18.0 + second)));
}

TEST_CASE("a hypothesis near a better supported one fades into its surface") {
  // t = .02 at infinity; the kernel is 1 − (Δ / t)².
  const auto second = [](double apart) {
    const Surfaces s = voted({{0, 2, 1, 0.45}, {apart, 1, 1, 0.45}});
    return s.count == 2 ? s.surface[0].opacity : 0.0;
  };
  CHECK(second(0.0172) == 0);                            // kernel above .25
  CHECK((second(0.0175) > 0 && second(0.0175) < 0.05));  // just below .25
  CHECK(second(0.0185) > second(0.0175));
  CHECK(second(0.0211) == Approx(0.25));  // alone: presence .5, opacity .5
}

TEST_CASE("surfaces of a pixel change continuously with its hypotheses") {
  // Sum over the surfaces of share · ρ. The image is continuous if this sum is.
  const auto seen = [](const std::vector<Vote>& votes) {
    const Surfaces s = voted(votes);
    double through = 1, mean = 0;
    for (std::size_t l = 0; l < s.count; ++l) {
      mean += through * s.surface[l].opacity * s.surface[l].inverseDepth;
      through *= 1 - s.surface[l].opacity;
    }
    return mean;
  };
  for (int i = 0; i <= 4000; ++i) {
    const auto at = [&](double x) {
      return seen({{1 + x, 1, 1, 0.5}, {0.5, 3 * x * x, 1, 0.6}, {1.5 - x, 0.7, 1, 0.3}});
    };
    const double x = i / 4000.0;
    if (std::abs(x - 0.25) < 0.02) continue;  // the first and the third meet and become one surface
    INFO(x);
    CHECK(std::abs(at(x + 1e-7) - at(x)) < 1e-3);
  }
}

TEST_CASE("with equal support the lower candidate is the peak") {
  // At infinity all tolerances are .02.
  const std::vector<Vote> votes{{0, 1, 1, 0.9}, {0, 1, 0.06, 0.1}};
  const Surfaces tie = voted(votes);
  REQUIRE(tie.count == 1);
  CHECK(tie.margin == 0);
  // Three in a row; the outer two are not within each other's tolerance. The middle one wins in any order.
  for (const auto& [a, b, c] : {std::array{0.0, 0.015, 0.03}, std::array{0.015, 0.0, 0.03}}) {
    const Surfaces row = voted({{a, 1, 1, 0.9}, {b, 1, 1, 0.9}, {c, 1, 1, 0.9}});
    REQUIRE(row.count == 1);
    CHECK(row.surface[0].inverseDepth == Approx(0.015));
  }
  // Two of equal distance and weight: each one's kernel applies to the other; the peak is at the first.
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

TEST_CASE("holes are filled from their surroundings by pull and push") {
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

  // Levels of 5 × 3, 3 × 2, 2 × 1, 1 × 1 px. Pixels 0 and 4 are known: the upper left and right pixels at 3 × 2 weigh
  // .5, both pixels at 2 × 1 weigh .25 (shared/fill.h), and their mean of .4 is pushed down again.
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
