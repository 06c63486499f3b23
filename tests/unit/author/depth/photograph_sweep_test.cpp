// SPDX-License-Identifier: Apache-2.0
#include "author/depth/photograph_sweep.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <utility>

#include "author/backdrop/complete_depth.h"
#include "lab/generate/synthetic.h"
#include "support/posed_rig.h"
#include "support/without_avx2.h"

using namespace ibr;
using namespace ibr::test;

namespace {

constexpr int kWidth = 160, kHeight = 120;
constexpr double kWall = 8, kBoard = 3;  // distances along y, world units

// A board before a wall, photographed from positions around the first camera.
struct Place {
  std::vector<Camera> cameras;
  SyntheticScene scene;
  std::vector<SweepView> views;

  explicit Place(bool board = true) {
    for (const auto& [x, z] : {std::pair{0.0, 0.0}, {0.5, 0.0}, {-0.5, 0.1}, {0.1, 0.5}, {0.0, -0.5}, {1.2, 0.3}})
      cameras.push_back(lookingAlong({x, 0, z}, {0, 1, 0}, kWidth, kHeight, 1.2));
    SyntheticOptions options;
    options.cameras = cameras;
    options.planes = {{{0, kWall, 0}, {1, 0, 0}, {0, 0, 1}, 60, 60, 3, 0.3}};
    if (board) options.planes.push_back({{0, kBoard, 0}, {1, 0, 0}, {0, 0, 1}, 1.5, 1.5, 5, 0.1});
    options.cells = {{0, 1}};
    scene = makeScene(options);
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      SweepView view{cameras[i], ImageF(kWidth, kHeight, 1), {}};
      for (std::size_t p = 0; p < view.grey.values.size(); ++p)
        view.grey.values[p] = scene.photographs[i].values[3 * p + 1];
      views.push_back(std::move(view));
    }
  }
  SweptDepth swept(std::size_t sources = 5, double farthest = kWall) const {
    return sweptDepth(views[0], std::span(views).subspan(1, sources),
                      sweepRange({1 / farthest, 1 / kWall, 1 / kBoard}));
  }
  // Returns the share of pixels within 3 % of the true depth; a border of 8 px does not count.
  double shareRight(const SweptDepth& depth) const {
    const ImageF truth = renderDepth(scene, cameras[0]);
    int right = 0, all = 0;
    for (int y = 8; y < kHeight - 8; ++y)
      for (int x = 8; x < kWidth - 8; ++x, ++all)
        right += std::abs(double(depth.inverseDepth.pixel(x, y)[0]) * double(truth.pixel(x, y)[0]) - 1) < 0.03;
    return double(right) / all;
  }
};

}  // namespace

TEST_CASE("swept depth is correct, also where a surface is hidden in half of the sources") {
  const Place place;
  CHECK(place.shareRight(place.swept()) > 0.97);
  CHECK(place.shareRight(place.swept(1)) < place.shareRight(place.swept()));
}

TEST_CASE("the order of sources and the world's pose do not change swept depth") {
  Place place(false);
  const SweptDepth before = place.swept();
  std::swap(place.views[1], place.views[4]);
  CHECK(place.swept().inverseDepth == before.inverseDepth);
  const glm::dquat turn = glm::normalize(glm::dquat(0.8, 0.3, -0.4, 0.2));
  for (SweepView& view : place.views)
    view.camera.pose = {turn * view.camera.pose.position + glm::dvec3(50, -20, 7),
                        glm::normalize(turn * view.camera.pose.rotation)};
  const SweptDepth moved = place.swept();
  std::size_t off = 0;
  for (std::size_t p = 0; p < before.inverseDepth.values.size(); ++p)
    off += std::abs(moved.inverseDepth.values[p] - before.inverseDepth.values[p]) > 1e-3f;
  CHECK(off < before.inverseDepth.values.size() / 500);
}

TEST_CASE("masked pixels of the photograph have no depth, and masked pixels of a source do not count") {
  Place place(false);
  place.views[0].mask = Image8(kWidth, kHeight, 1, 255);
  for (int x = 0; x < kWidth; ++x) place.views[0].mask.pixel(x, 60)[0] = 0;
  for (float& value : place.views[2].grey.values) value = 255 - value;
  place.views[2].mask = Image8(kWidth, kHeight, 1, 0);
  CHECK(place.shareRight(place.swept()) > 0.97);
  // All sources but one are inverted and masked, so too few sources remain.
  for (std::size_t i = 3; i < place.views.size(); ++i) {
    for (float& value : place.views[i].grey.values) value = 255 - value;
    place.views[i].mask = Image8(kWidth, kHeight, 1, 0);
  }
  const SweptDepth depth = place.swept();
  for (int x = 0; x < kWidth; ++x) CHECK(depth.inverseDepth.pixel(x, 60)[0] == kUnknownDepth);
  CHECK(place.shareRight(depth) > 0.8 * place.shareRight(Place(false).swept(1)));
}

TEST_CASE("unrelated sources do not count where the better half agrees") {
  Place place(false);
  for (const std::size_t i : {2, 4})
    for (float& value : place.views[i].grey.values) value = 255 - value;
  CHECK(place.shareRight(place.swept()) > 0.97);
}

TEST_CASE("sky above a wall is found at infinity") {
  Place place(false);
  const SweptDepth wall = place.swept(5, 40);
  for (SweepView& view : place.views)
    for (int y = 0; y < 60; ++y)
      for (int x = 0; x < kWidth; ++x)
        view.grey.pixel(x, y)[0] =
            y < 50 ? 150 + 30 * float(std::sin(0.5 * x + 0.3 * y) + std::sin(0.4 * y - 0.3 * x))  // distant clouds
                   : view.grey.pixel(x, y)[0];
  const SweptDepth depth = place.swept(5, 40), compact = place.swept();
  int sky = 0;
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < kWidth; ++x) {
      sky += depth.sky.pixel(x, y)[0] == 255;
      if (depth.sky.pixel(x, y)[0]) CHECK(depth.inverseDepth.pixel(x, y)[0] == 0);
    }
  CHECK(sky > 40 * kWidth * 9 / 10);
  for (int y = 64; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) CHECK(depth.sky.pixel(x, y)[0] == 0);
  for (const SweptDepth* none : {&wall, &compact})  // no sky: all tracks are at similar distances
    for (const std::uint8_t value : none->sky.values) CHECK(value == 0);
  const std::vector<double> deep{1.0 / 40, 1 / kWall, 1 / kBoard}, near{1 / kWall, 1 / kWall, 1 / kBoard};
  CHECK(mostReachInfinity({deep, near, deep, {}}));
  CHECK_FALSE(mostReachInfinity({deep, near, {}, {}}));
  CHECK_FALSE(mostReachInfinity({{}, {}}));
  const SweptDepth swept = sweptDepth(place.views[0], std::span(place.views).subspan(1), sweepRange(near, true));
  CHECK(std::ranges::count(swept.sky.values, 255) > 40 * kWidth * 9 / 10);
}

TEST_CASE("the sweep range covers all tracks but outliers, and a few more tracks do not change it") {
  std::vector<double> tracks;
  for (int i = 0; i < 1000; ++i) tracks.push_back(0.05 + 0.00025 * i);
  const SweepRange range = sweepRange(tracks);
  CHECK(range.far == 0);  // the farthest track's inverse depth is a sixth of the nearest's
  CHECK(range.near >= 1.3 * 0.298);
  CHECK(range.near < 1.3 * 0.3 * 1.1);
  for (const double more : {0.1, 0.2, 0.25, 50.0}) tracks.push_back(more);
  CHECK(sweepRange(tracks).near == range.near);
  const std::vector<double> wall(20, 0.25);
  CHECK(sweepRange(wall).far > 0.6 * 0.25);
  CHECK(sweepRange(wall).far <= 0.7 * 0.25);
  CHECK(sweepRange(wall, true).far == 0);
  CHECK(sweepRange(wall, true).near == sweepRange(wall).near);
}

TEST_CASE("degenerate photographs have finite depth or none") {
  const auto check = [](const SweptDepth& depth) {
    for (const float rho : depth.inverseDepth.values) CHECK((rho == kUnknownDepth || (std::isfinite(rho) && rho >= 0)));
  };
  Place place(false);
  for (SweepView& view : place.views) view.camera.pose.position = {0, 0, 0};
  check(place.swept());
  place = Place(false);
  for (SweepView& view : place.views) std::fill(view.grey.values.begin(), view.grey.values.end(), 90.0f);
  check(place.swept());
  check(sweptDepth(place.views[0], std::span(place.views).subspan(1), sweepRange({1e-12})));
  check(sweptDepth(place.views[0], std::span(place.views).subspan(1), sweepRange({1e12})));
  for (SweepView& view : place.views) {
    view.camera.intrinsics = resized(view.camera.intrinsics, 1, 1);
    view.grey = ImageF(1, 1, 1, 90.0f);
  }
  check(place.swept());
}

TEST_CASE("swept depth is bit-identical in both versions of the inner loops, also with masks") {
  Place place;
  place.views[2].mask = Image8(kWidth, kHeight, 1, 255);
  for (int x = 0; x < kWidth / 2; ++x) place.views[2].mask.pixel(x, kHeight / 2)[0] = 0;
  const SweptDepth widest = place.swept();
  const SweptDepth portable = withoutAvx2([&] { return place.swept(); });
  CHECK(portable.inverseDepth == widest.inverseDepth);
  CHECK(portable.sky == widest.sky);
}
