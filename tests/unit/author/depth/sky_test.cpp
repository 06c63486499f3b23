// SPDX-License-Identifier: Apache-2.0
#include "author/depth/sky.h"

#include <algorithm>
#include <catch2/catch.hpp>

using namespace ibr;

namespace {

constexpr int kWidth = 80, kHeight = 60;

// A house below row 30, where infinity costs far more than the best depth. Above, infinity is as good as any depth.
struct Place {
  ImageF excess{kWidth, kHeight, 1, 0.0f};
  Image8 cost{kWidth, kHeight, 1, 20};

  Place() { fill(0, 30, kWidth, kHeight, 400, 10); }
  void fill(int left, int top, int right, int bottom, float its, int costs) {
    for (int y = top; y < bottom; ++y)
      for (int x = left; x < right; ++x) {
        excess.pixel(x, y)[0] = its;
        cost.pixel(x, y)[0] = std::uint8_t(costs);
      }
  }
  Image8 sky() const { return skyOf(excess, cost); }
};

bool at(const Image8& sky, int x, int y) {
  return sky.pixel(x, y)[0] != 0;
}

}  // namespace

TEST_CASE("sky is the region that matches at infinity, two pixels away from all else") {
  const Image8 sky = Place().sky();
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) CHECK(at(sky, x, y) == (y < 28));
}

TEST_CASE("a clear sky without texture is sky, a wall without texture below a roof is not") {
  Place place;
  place.fill(0, 0, 40, 20, 120, 100);   // clear sky
  place.fill(10, 40, 70, 58, 90, 100);  // wall without texture
  const Image8 sky = place.sky();
  CHECK(at(sky, 20, 10));
  CHECK_FALSE(at(sky, 40, 50));
  place.fill(0, 0, 40, 20, 120, 20);  // as the clear sky, but another depth matches
  CHECK_FALSE(at(place.sky(), 20, 10));
}

TEST_CASE("a region enclosed by a wire is sky if half of it matches at infinity as well as at any depth") {
  Place cut;
  cut.fill(0, 8, kWidth, 9, 400, 10);
  const Image8 sky = cut.sky();
  CHECK(at(sky, 40, 2));
  CHECK_FALSE(at(sky, 40, 8));
  CHECK(at(sky, 40, 15));
  cut.fill(0, 9, 45, 30, 40, 20);  // more than half of the enclosed region
  CHECK_FALSE(at(cut.sky(), 60, 15));
  CHECK(at(cut.sky(), 40, 2));
  cut.fill(0, 8, 10, 9, 40, 20);  // reconnects the region with the border
  CHECK(at(cut.sky(), 60, 15));
}

TEST_CASE("no sky is found where infinity matches worse than a depth, or in small regions") {
  Place near;
  near.fill(0, 0, kWidth, 30, 40, 20);
  Place small;
  small.fill(22, 0, kWidth, 30, 400, 10);  // after both fills, sky is left for x < 22, y < 18
  small.fill(0, 18, kWidth, 30, 400, 10);
  for (const Place* place : {&near, &small})
    CHECK(std::ranges::none_of(place->sky().values, [](int value) { return value != 0; }));
}
