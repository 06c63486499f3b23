// SPDX-License-Identifier: Apache-2.0
#include "reference/composer.h"
#include "scene/capture_spacing.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <glm/gtc/quaternion.hpp>
#include <vector>

#include "ibr/metrics.h"
#include "ibr/scene.h"
#include "lab/generate/synthetic.h"
#include "support/error_of.h"

using namespace ibr;
using ibr::reference::Composed;
using ibr::reference::Composer;
using ibr::reference::ComposerPhotograph;
using ibr::test::errorOf;

namespace {

constexpr int kWidth = 96, kHeight = 72;
constexpr double kSpacing = 0.5;

Camera cameraAt(glm::dvec3 position, double yaw = 0) {
  return {pinholeFromFov(kWidth, kHeight, 0.9), {position, glm::angleAxis(yaw, glm::dvec3(0, 1, 0))}};
}

// A wall, a sign in front, and five photographs with exact depth.
struct Stage {
  Stage() {
    SyntheticOptions options;
    for (const glm::dvec3 at :
         {glm::dvec3(0, 0, 0), {kSpacing, 0, 0}, {0, kSpacing, 0}, {kSpacing, kSpacing, 0}, {2 * kSpacing, 0, 0}})
      options.cameras.push_back(cameraAt(at));
    options.planes = {{.origin = {0, 0, -5}, .extentU = 24, .extentV = 16, .wavelength = 1.2},
                      {.origin = {0.3, 0.1, -3}, .extentU = 1, .extentV = 0.8, .seed = 2, .wavelength = 0.8}};
    options.cells = {{0, 1, 2}};
    made = makeScene(options);
    for (const Camera& camera : options.cameras) {
      const ImageF depth = renderDepth(made, camera);
      ComposerPhotograph& one = photographs.emplace_back();
      one.camera = camera;
      one.depth = {ImageF(kWidth, kHeight, 1), Image8(kWidth, kHeight, 1, 3), ImageF(kWidth, kHeight, 1, 0.9f),
                   2 / (camera.intrinsics.fx * kSpacing), 0};
      std::ranges::transform(depth.values, one.depth.inverseDepth.values.begin(), [](float d) { return 1 / d; });
    }
  }

  Composed compose(const Camera& view) const {
    return Composer(photographs).compose(view, [this](std::size_t i) -> const Image8& { return made.photographs[i]; });
  }

  SyntheticScene made;
  std::vector<ComposerPhotograph> photographs;
};

int largestDifference(const Image8& a, const Image8& b) {
  return difference(a, b, 0).largest;
}

const Camera kBetween = cameraAt({0.2, 0.2, 0.05});

}  // namespace

TEST_CASE("at a photograph's pose the image equals the photograph for any depth, border included") {
  Stage stage;
  const bool wrong = GENERATE(false, true);
  if (wrong)
    for (float& value : stage.photographs[1].depth.inverseDepth.values) value = 0.35f;
  const Composed own = stage.compose(stage.photographs[1].camera);
  CHECK(psnr(own.picture, stage.made.photographs[1]) > 45);
  CHECK(std::ranges::count_if(own.picture.values, [](int v) { return v == 0; }) == 0);
}

TEST_CASE("with exact depth a view between photographs is near the truth") {
  const Stage stage;
  const Composed between = stage.compose(kBetween);
  const Image8 truth = renderTruth(stage.made, kBetween);
  CHECK(psnr(between.picture, truth) > 33);
  const ImageF depth = renderDepth(stage.made, kBetween);
  std::size_t right = 0;
  for (std::size_t at = 0; at < depth.values.size(); ++at)
    right += std::abs(between.inverseDepth.values[at] - 1 / depth.values[at]) < 0.01f;
  CHECK(double(right) / double(depth.values.size()) > 0.97);
}

TEST_CASE("a contradicted surface is outvoted") {
  Stage stage;
  const Image8 truth = renderTruth(stage.made, kBetween);
  const double before = psnr(stage.compose(kBetween).picture, truth);
  ComposerPhotograph& liar = stage.photographs[0];  // a surface in front that this photograph alone has
  for (int y = 10; y < 60; ++y)
    for (int x = 10; x < 40; ++x) {
      liar.depth.inverseDepth.pixel(x, y)[0] = 0.8f;
      liar.depth.confirmations.pixel(x, y)[0] = 0;
      liar.depth.consensus.pixel(x, y)[0] = 0.1f;
    }
  const double outvoted = psnr(stage.compose(kBetween).picture, truth);
  CHECK(outvoted > before - 4);
  for (std::uint8_t& c : liar.depth.confirmations.values) c = 3;  // confirmed surfaces are shown
  for (float& a : liar.depth.consensus.values) a = 0.9f;
  CHECK(psnr(stage.compose(kBetween).picture, truth) < outvoted - 3);
}

TEST_CASE("moving, turning and scaling the world does not change the image") {
  Stage stage;
  const Composed before = stage.compose(kBetween);
  const double scale = GENERATE(1e-3, 1.0, 1e4);
  const glm::dvec3 shift = 1e5 * scale * glm::dvec3(1, -2, 3);
  const glm::dquat turn = glm::normalize(glm::dquat(0.9, 0.1, -0.3, 0.2));
  const auto moved = [&](Camera camera) {
    camera.pose = {turn * (scale * camera.pose.position) + shift, turn * camera.pose.rotation};
    return camera;
  };
  for (ComposerPhotograph& one : stage.photographs) {
    one.camera = moved(one.camera);
    one.depth.step /= scale;
    for (float& value : one.depth.inverseDepth.values) value = float(double(value) / scale);
  }
  const Composed after = stage.compose(moved(kBetween));
  CHECK(difference(before.picture, after.picture, 1).shareAbove < 0.002);
}

TEST_CASE("the order of photographs and the number of threads do not change the image") {
  Stage stage;
  const Composed before = stage.compose(kBetween);
  const Composed threaded =
      Composer(stage.photographs, {.threads = 3}).compose(kBetween, [&](std::size_t i) -> const Image8& {
        return stage.made.photographs[i];
      });
  CHECK(threaded.picture == before.picture);
  std::ranges::reverse(stage.photographs);
  std::ranges::reverse(stage.made.photographs);
  CHECK(largestDifference(stage.compose(kBetween).picture, before.picture) <= 1);
}

TEST_CASE("a camera step of a thousandth of the spacing changes the image little") {
  const Stage stage;
  for (int i = 0; i < 8; ++i) {
    const Camera here = cameraAt({0.05 + 0.06 * i, 0.1 + 0.02 * i, 0.04 * i}, 0.02 * i);
    Camera there = here;
    there.pose.position += kSpacing * 1e-3 * glm::dvec3(1, 0.5, -0.5);
    CHECK(difference(stage.compose(here).picture, stage.compose(there).picture, 0).meanAbsolute < 0.5);
  }
}

TEST_CASE("with fewer candidates than photographs weights lie between 0 and 1") {
  const Stage stage;
  const Composer composer(stage.photographs, {.candidates = 3});
  const auto chosen = composer.candidates(kBetween);
  REQUIRE(chosen.size() == 3);
  for (const auto& one : chosen) {
    CHECK(one.weight >= 0);
    CHECK(one.weight <= 1);
  }
  CHECK(chosen[0].weight == 1);
}

TEST_CASE("views without photographs are empty, and depth at infinity is drawn") {
  Stage stage;
  const Composed behind = stage.compose(cameraAt({0, 0, 0}, 3.14159));
  CHECK(std::ranges::all_of(behind.picture.values, [](int v) { return v == 0; }));
  for (ComposerPhotograph& one : stage.photographs) std::ranges::fill(one.depth.inverseDepth.values, 0.0f);
  const Composed far = stage.compose(kBetween);
  CHECK(std::ranges::all_of(far.inverseDepth.values, [](float w) { return w == 0; }));
  CHECK(std::ranges::count(far.picture.values, 0) == 0);
}

TEST_CASE("tiers distinguish confirmed and completed depth") {
  Stage stage;
  const auto tier = [](const Composed& composed) {
    return (255 - composed.picture.pixel(kWidth / 2, kHeight / 2)[3]) / 64;
  };
  CHECK(tier(stage.compose(kBetween)) == kTierConsistent);
  for (ComposerPhotograph& one : stage.photographs) std::ranges::fill(one.depth.confirmations.values, std::uint8_t(0));
  CHECK(tier(stage.compose(kBetween)) == kTierCompleted);
}

TEST_CASE("invalid photographs are refused by number") {
  Stage stage;
  CHECK(errorOf([] { Composer({}); }).code() == ErrorCode::invalidInput);
  const auto refusal = [&](auto&& spoil) {
    std::vector<ComposerPhotograph> spoilt = stage.photographs;
    spoil(spoilt[2]);
    const Error error = errorOf([&] { Composer{spoilt}; });
    CHECK(error.code() == ErrorCode::invalidInput);
    CHECK_THAT(error.what(), Catch::Contains("photograph 2"));
  };
  refusal([](ComposerPhotograph& p) { p.camera.intrinsics.model = CameraModel::equirectangular; });
  refusal([](ComposerPhotograph& p) { p.depth.confirmations = Image8(3, 3, 1); });
  refusal([](ComposerPhotograph& p) { p.depth.inverseDepth = {}; });
  for (const double step : {0.0, -1.0, std::nan("")}) refusal([&](ComposerPhotograph& p) { p.depth.step = step; });
}
