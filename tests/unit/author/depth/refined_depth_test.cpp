// SPDX-License-Identifier: Apache-2.0
#include "author/depth/refined_depth.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "author/backdrop/complete_depth.h"
#include "lab/generate/synthetic.h"
#include "support/posed_rig.h"
#include "support/without_avx2.h"

using namespace ibr;
using namespace ibr::test;

namespace {

constexpr int kWidth = 80, kHeight = 60;  // size of the depth map, px
constexpr float kLevel = 0.02f;

// A slanted wall, photographed from positions around the first; its depth is swept in whole levels.
struct Wall {
  std::vector<SweepView> views;  // twice the depth map's size
  ImageF truth;
  SweptDepth swept;

  explicit Wall(double slant = 0.5) {
    SyntheticOptions options;
    for (const auto& [x, z] : {std::pair{0.0, 0.0}, {0.5, 0.0}, {-0.5, 0.1}, {0.1, 0.5}, {0.0, -0.5}})
      options.cameras.push_back(lookingAlong({x, 0, z}, {0, 1, 0}, 2 * kWidth, 2 * kHeight, 1.2));
    options.planes = {{{0, 6, 0}, glm::normalize(glm::dvec3(1, slant, 0)), {0, 0, 1}, 60, 60, 3, 0.3}};
    options.cells = {{0, 1}};
    const SyntheticScene scene = makeScene(options);
    for (std::size_t i = 0; i < options.cameras.size(); ++i) {
      SweepView view{options.cameras[i], ImageF(2 * kWidth, 2 * kHeight, 1), {}};
      for (std::size_t p = 0; p < view.grey.values.size(); ++p)
        view.grey.values[p] = scene.photographs[i].values[3 * p + 1];
      views.push_back(std::move(view));
    }
    truth = renderDepth(scene, lookingAlong({0, 0, 0}, {0, 1, 0}, kWidth, kHeight, 1.2));
    swept = {ImageF(kWidth, kHeight, 1), Image8(kWidth, kHeight, 1, 0), kLevel};
    for (std::size_t p = 0; p < truth.values.size(); ++p) {
      truth.values[p] = 1 / truth.values[p];
      swept.inverseDepth.values[p] = kLevel * std::round(truth.values[p] / kLevel);
    }
  }
  SweptDepth refined(std::size_t sources = 4) const {
    SweptDepth depth = swept;
    refineDepth(depth, views[0], std::span(views).subspan(1, sources));
    return depth;
  }
  // Returns the median error, levels; pixels at the border do not count.
  double error(const SweptDepth& depth) const {
    std::vector<double> off;
    for (int y = 6; y < kHeight - 6; ++y)
      for (int x = 6; x < kWidth - 6; ++x)
        off.push_back(std::abs(double(depth.inverseDepth.pixel(x, y)[0]) - double(truth.pixel(x, y)[0])) / kLevel);
    std::nth_element(off.begin(), off.begin() + std::ptrdiff_t(off.size() / 2), off.end());
    return off[off.size() / 2];
  }
};

}  // namespace

TEST_CASE("swept depth is refined to a fraction of a sweep level, also on slanted walls") {
  for (const double slant : {0.0, 0.5, -1.2}) {
    CAPTURE(slant);
    const Wall wall(slant);
    CHECK(wall.error(wall.refined()) < 0.06);
    CHECK(wall.error(wall.refined(1)) < 0.12);
  }
  const Wall wall;
  CHECK(wall.error(wall.swept) > 0.2);
}

TEST_CASE("refined depth is bit-identical in both versions of the inner loops") {
  const Wall wall;
  const SweptDepth widest = wall.refined();
  const SweptDepth portable = withoutAvx2([&] { return wall.refined(); });
  CHECK(portable.inverseDepth == widest.inverseDepth);
}

TEST_CASE("refined depth is deterministic, and as accurate with reordered sources") {
  Wall wall;
  const SweptDepth before = wall.refined();
  CHECK(wall.refined().inverseDepth == before.inverseDepth);
  std::swap(wall.views[1], wall.views[4]);
  CHECK(wall.error(wall.refined()) < 0.06);
}

TEST_CASE("sky and unknown depth are not refined, and do not affect their neighbours") {
  Wall wall;
  for (int x = 0; x < kWidth; ++x) {
    wall.swept.inverseDepth.pixel(x, 20)[0] = kUnknownDepth;
    wall.swept.inverseDepth.pixel(x, 40)[0] = 0;
    wall.swept.sky.pixel(x, 40)[0] = 255;
  }
  const SweptDepth depth = wall.refined();
  CHECK(depth.sky == wall.swept.sky);
  for (int x = 0; x < kWidth; ++x) {
    CHECK(depth.inverseDepth.pixel(x, 20)[0] == kUnknownDepth);
    CHECK(depth.inverseDepth.pixel(x, 40)[0] == 0);
  }
  CHECK(wall.error(depth) < 0.07);
}

TEST_CASE("depth is not refined where sources are unrelated or have no texture") {
  Wall wall;
  std::mt19937 random(3);
  for (std::size_t i = 1; i < wall.views.size(); ++i)
    for (float& level : wall.views[i].grey.values) level = float(random() % 256);
  CHECK(wall.refined().inverseDepth == wall.swept.inverseDepth);
  for (std::size_t i = 1; i < wall.views.size(); ++i) wall.views[i].grey = ImageF(2 * kWidth, 2 * kHeight, 1, 100);
  CHECK(wall.refined().inverseDepth == wall.swept.inverseDepth);  // without texture
  CHECK(wall.refined(0).inverseDepth == wall.swept.inverseDepth);
  for (std::size_t i = 1; i < wall.views.size(); ++i)
    wall.views[i].camera = lookingAlong({0, 0.2, 0}, {0, -1, 0}, 2 * kWidth, 2 * kHeight, 1.2);
  CHECK(wall.refined().inverseDepth == wall.swept.inverseDepth);
}

TEST_CASE("masked pixels of a source are not read") {
  Wall wall;
  for (const std::size_t i : {1, 2, 3}) {
    for (float& level : wall.views[i].grey.values) level = 255 - level;
    wall.views[i].mask = Image8(2 * kWidth, 2 * kHeight, 1, 0);
  }
  CHECK(wall.error(wall.refined()) < 0.12);
}

TEST_CASE("images of a few pixels are refined without reading outside of them") {
  for (const int side : {1, 3, 9}) {
    CAPTURE(side);
    const Camera camera = lookingAlong({0, 0, 0}, {0, 1, 0}, side, side, 1.2);
    const std::vector<SweepView> views(3, {camera, ImageF(side, side, 1, 50), {}});
    SweptDepth depth{ImageF(side, side, 1, 0.5f), Image8(side, side, 1, 0), kLevel};
    refineDepth(depth, views[0], std::span(views).subspan(1));
    CHECK(depth.inverseDepth == ImageF(side, side, 1, 0.5f));
  }
}
