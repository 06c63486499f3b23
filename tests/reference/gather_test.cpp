// SPDX-License-Identifier: Apache-2.0
// Vote and gather (Composition::gathered): relations that hold for the reference implementation.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <glm/gtc/quaternion.hpp>

#include "base/srgb.h"
#include "ibr/metrics.h"
#include "reference/gather_stage.h"
#include "support/error_of.h"

using namespace ibr;
using namespace ibr::test;
using ibr::reference::Composed;

namespace {

constexpr double kPi = std::numbers::pi;
const Camera kBeside = cameraAt({1.6, 0.2, 0.2}, 0.3, -0.03, 144, 108);  // a quarter radian away from the photographs
const Camera kBetween = cameraAt({0.22, 0.17, 0.06}, 0.02, -0.01, 144, 108);

// Largest colour difference, 8-bit levels before rounding.
double largestDifference(const Composed& a, const Composed& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.colour.values.size(); ++i)
    largest = std::max(largest, std::abs(double(a.colour.values[i]) - double(b.colour.values[i])));
  return largest;
}

// Share of pixels of a tier; −1: share of holes.
double shareOf(const Composed& composed, int tier) {
  const int code = tier < 0 ? 0 : 255 - 64 * tier;
  std::size_t count = 0;
  for (std::size_t i = 3; i < composed.picture.values.size(); i += 4) count += composed.picture.values[i] == code;
  return double(count) / double(composed.picture.values.size() / 4);
}

Image8 truthOf(const GatherStage& stage, const Camera& view) {
  return renderTruth(stage.made, view);
}

double quality(const GatherStage& stage, const Camera& view) {
  return psnr(stage.compose(view).picture, truthOf(stage, view));
}

const GatherStage& wall() {
  static const GatherStage stage = gatherStage(wallOptions());
  return stage;
}
const GatherStage& room() {
  static const GatherStage stage = gatherStage(roomOptions());
  return stage;
}

struct Block {
  int left, top, right, bottom;
  bool holds(glm::dvec2 at) const { return at.x >= left && at.x < right && at.y >= top && at.y < bottom; }
};

// Returns the photograph with a block filled with `colour` and mask value `alpha`.
Image8 withMasked(const Image8& rgb, const Block& block, std::array<std::uint8_t, 3> colour, std::uint8_t alpha = 0) {
  Image8 result(rgb.width, rgb.height, 4, 255);
  for (int y = 0; y < rgb.height; ++y)
    for (int x = 0; x < rgb.width; ++x) {
      std::copy_n(rgb.pixel(x, y).begin(), 3, result.pixel(x, y).begin());
      if (!block.holds({x + 0.5, y + 0.5})) continue;
      std::ranges::copy(colour, result.pixel(x, y).begin());
      result.pixel(x, y)[3] = alpha;
    }
  return result;
}

}  // namespace

TEST_CASE("synthetic scenes for the gather are valid") {
  for (const GatherStage* stage : {&wall(), &room()}) {
    CHECK(validate(stage->made.scene).empty());
    for (const Cell& backdrop : stage->made.scene.backdrops) {
      CHECK(backdrop.mesh.tier0Count() > backdrop.mesh.triangles.size() / 2);
      CHECK(std::ranges::all_of(backdrop.mesh.inverseDistance, [](float rho) { return rho > 0; }));
    }
  }
  CHECK(wall().made.scene.backdrops[0].mesh.tier0Count() < wall().made.scene.backdrops[0].mesh.triangles.size());
}

TEST_CASE("gathered: at a photograph's pose the image equals the photograph for any depth") {
  GatherOptions options = wallOptions();
  const bool wrong = GENERATE(false, true), completed = GENERATE(false, true);
  if (completed) options.evidence = [](std::size_t, glm::dvec2) { return Evidence{0, 0.1f}; };
  if (wrong)
    options.inverseDepth = [](std::size_t node, glm::dvec2, double rho) { return node == 1 ? 1.4 * rho : rho; };
  const GatherStage stage = gatherStage(options);
  for (std::size_t n = 0; n < 3; ++n) {
    const Composed own = stage.compose(stage.made.scene.nodes[n].camera);
    CHECK(psnr(own.picture, stage.made.photographs[n]) > 45);
    CHECK(shareOf(own, -1) == 0);
  }
}

TEST_CASE("gathered: photographs beside the view are sampled more coarsely for uncertain surfaces") {
  double sharper = 1e9;
  for (const float consensus : {1.0f, 0.5f, 0.25f, 0.0f}) {
    CAPTURE(consensus);
    GatherOptions options = wallOptions();
    for (TexturedPlane& plane : options.planes) plane.wavelength = 0.15;
    options.evidence = [&](std::size_t, glm::dvec2) { return Evidence{2, consensus}; };
    const Composed composed = gatherStage(options).compose(kBeside);
    double energy = 0;
    for (int y = 0; y < composed.colour.height; ++y)
      for (int x = 1; x < composed.colour.width; ++x)
        energy += std::abs(double(composed.colour.pixel(x, y)[1]) - double(composed.colour.pixel(x - 1, y)[1]));
    if (consensus == 0.5f)
      CHECK(energy == Approx(sharper).epsilon(0.01));  // opacities differ, but the mip levels that are read do not
    else
      CHECK(energy < 0.98 * sharper);
    sharper = energy;
  }
}

TEST_CASE("gathered: with exact depth a view between photographs is near the truth") {
  CHECK(quality(wall(), kBetween) > 33);
  const Composed composed = wall().compose(kBetween);
  const ImageF depth = renderDepth(wall().made, kBetween);
  std::size_t right = 0;
  for (std::size_t at = 0; at < depth.values.size(); ++at)
    right += std::abs(double(composed.inverseDepth.values[at]) * double(depth.values[at]) - 1) < 0.01;
  CHECK(double(right) / double(depth.values.size()) > 0.95);
}

TEST_CASE("gathered: the order of the photographs does not change the image") {
  for (const GatherStage* stage : {&wall(), &room()}) {
    FramePlan plan = stage->plan(kBetween);
    const Composed before = stage->compose(plan);
    std::ranges::rotate(plan.photographs, plan.photographs.begin() + 1);
    CHECK(largestDifference(stage->compose(plan), before) < 1e-3);
    std::ranges::reverse(plan.photographs);
    CHECK(largestDifference(stage->compose(plan), before) < 1e-3);
  }
}

TEST_CASE("gathered: the number of threads does not change the image") {
  const FramePlan plan = wall().plan(kBetween);
  const Composed threaded = reference::composeGathered(wall().made.scene, plan, 0, wall().sources(), 3);
  CHECK(threaded.colour == wall().compose(plan).colour);
}

TEST_CASE("gathered: moving, turning and scaling the world does not change the image") {
  for (const GatherStage* from : {&wall(), &room()}) {
    const Composed before = from->compose(kBetween);
    const double scale = GENERATE(1.0, 1024.0);  // a power of two, so that ρ has the same mantissa
    const glm::dquat turn = glm::normalize(glm::dquat(0.9, 0.1, -0.3, 0.2));
    const glm::dvec3 shift = scale * glm::dvec3(120, -340, 560);
    const auto moved = [&](Camera camera) {
      camera.pose = {turn * (scale * camera.pose.position) + shift, turn * camera.pose.rotation};
      return camera;
    };
    GatherStage stage = *from;
    for (Node& node : stage.made.scene.nodes) {
      node.camera = moved(node.camera);
      node.depthScale /= scale;
    }
    for (Cell& backdrop : stage.made.scene.backdrops)
      for (float& rho : backdrop.mesh.inverseDistance) rho = float(double(rho) / scale);
    FramePlan plan = stage.plan(moved(kBetween));
    plan.gather.spacing *= scale;
    const Composed after = stage.compose(plan);
    CHECK(largestDifference(after, before) < 1e-6 * 255);
    double depth = 0;
    for (std::size_t at = 0; at < before.inverseDepth.values.size(); ++at)
      depth = std::max(
          depth, std::abs(scale * double(after.inverseDepth.values[at]) - double(before.inverseDepth.values[at])));
    CHECK(depth < 1e-6);
  }
}

TEST_CASE("gathered: a single photograph is shown, and holes are filled from its surroundings") {
  FramePlan plan = wall().plan(cameraAt({0.1, 0, 0}, 0, 0, 160, 120));
  plan.photographs.resize(1);
  const Composed alone = wall().compose(plan);
  const Image8 truth = truthOf(wall(), plan.views[0]);
  CHECK(shareOf(alone, kTierConsistent) > 0.85);
  CHECK(shareOf(alone, kTierCompleted) == 0);
  CHECK(shareOf(alone, kTierFilled) > 0.01);
  Image8 confirmed(160, 120, 1, 0);
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 160; ++x) confirmed.pixel(x, y)[0] = alone.picture.pixel(x, y)[3] == 255;
  CHECK(psnr(alone.picture, truth, confirmed) > 33);

  FramePlan few = plan;
  few.settings.maxTier = kTierCompleted;
  const Composed unfilled = wall().compose(few);
  CHECK(shareOf(unfilled, kTierFilled) == 0);
  CHECK(shareOf(unfilled, -1) == Approx(shareOf(alone, kTierFilled) + shareOf(alone, -1)));
  CHECK(shareOf(unfilled, kTierConsistent) == shareOf(alone, kTierConsistent));

  Composed coloured = unfilled;
  fillColours(coloured);
  CHECK(shareOf(coloured, -1) == 0);
  CHECK(shareOf(coloured, kTierFilled) == shareOf(unfilled, -1));
  CHECK(coloured.inverseDepth.values == unfilled.inverseDepth.values);
  CHECK(psnr(coloured.picture, truth) > psnr(unfilled.picture, truth) + 3);
  for (std::size_t p = 0; p < truth.values.size() / 3; ++p)
    if (unfilled.picture.values[4 * p + 3] != 0)
      REQUIRE(std::equal(&unfilled.picture.values[4 * p], &unfilled.picture.values[4 * p + 4],
                         &coloured.picture.values[4 * p]));

  plan.photographs[0].weight = 0;  // a photograph of weight 0, about to be replaced
  CHECK(shareOf(wall().compose(plan), -1) == 1);
  plan.photographs.clear();
  CHECK(shareOf(wall().compose(plan), -1) == 1);
}

TEST_CASE("gathered: content at infinity looks the same from every position") {
  GatherOptions options = wallOptions();
  options.atInfinity = true;
  options.planes = {{.origin = {0, 0, -6}, .extentU = 40, .extentV = 30, .wavelength = 0.8}};
  const GatherStage stage = gatherStage(options);
  const Composed far = stage.compose(kBetween);
  CHECK(std::ranges::all_of(far.inverseDepth.values, [](float rho) { return rho == 0; }));
  CHECK(shareOf(far, kTierConsistent) == 1);
  CHECK(psnr(far.picture, truthOf(stage, kBetween)) > 36);
  Camera distant = kBetween;
  distant.pose.position += glm::dvec3(300, -200, 500);
  const Composed again = stage.compose(distant);
  CHECK(psnr(again.picture, truthOf(stage, distant)) > 36);
  CHECK(shareOf(again, kTierConsistent) == 1);
}

TEST_CASE("gathered: a panorama votes and is shown in every direction, seam and poles included") {
  for (const glm::dvec3 axis : {glm::dvec3(0, 1, 0), glm::dvec3(1, 0, 0)})
    for (int quarter = 0; quarter < 4; ++quarter) {
      Camera view = cameraAt({0.2, 0.1, 0.15}, 0, 0, 96, 96, kPi / 2);
      view.pose.rotation = glm::angleAxis(quarter * kPi / 2, axis);
      const Composed composed = room().compose(view);
      CHECK(shareOf(composed, -1) == 0);
      CHECK(shareOf(composed, kTierConsistent) > 0.88);  // no triangle connects two sides of a corner
      CHECK(psnr(composed.picture, truthOf(room(), view)) > 28);
    }
  for (const std::size_t n : {1u, 2u})  // the pinholes beside the panorama
    CHECK(psnr(room().compose(room().made.scene.nodes[n].camera).picture, room().made.photographs[n]) > 45);
}

TEST_CASE("gathered: masked pixels are not shown") {
  // A person is masked in the second photograph. Depth is that of the background, as a build completes the depth.
  const Block person{70, 40, 150, 140};
  GatherOptions options = wallOptions();
  options.evidence = [&](std::size_t node, glm::dvec2 pixel) {
    return node == 1 && person.holds(pixel) ? Evidence{0, 0.1f} : Evidence{};
  };
  GatherStage stage = gatherStage(options);
  const Camera near = cameraAt({0.42, 0.14, 0.02}, 0.05, 0, 144, 108), own = stage.made.scene.nodes[1].camera;
  const Image8 photograph = stage.made.photographs[1], truth = truthOf(stage, near);
  stage.setPhotograph(1, withMasked(photograph, person, {255, 0, 255}));
  const Composed masked = stage.compose(near), maskedOwn = stage.compose(own);
  CHECK(psnr(masked.picture, truth) > 30);
  CHECK(psnr(maskedOwn.picture, photograph) > 25);  // the other photographs show the background
  stage.setPhotograph(1, withMasked(photograph, person, {0, 255, 0}));
  const auto shareAbove = [](const Composed& a, const Composed& b) {
    return difference(a.picture, b.picture, 2).shareAbove;
  };
  CHECK(shareAbove(stage.compose(near), masked) < 0.02);  // differences only along the mask's border
  CHECK(shareAbove(stage.compose(own), maskedOwn) < 0.01);

  stage.setPhotograph(1, withMasked(photograph, person, {255, 0, 255}, 255));  // an opaque mask, which hides nothing
  CHECK(psnr(stage.compose(near).picture, truth) < 20);
}

TEST_CASE("gathered: gains equalise photographs of different exposures") {
  constexpr std::array kGains{glm::dvec3(2.2, 1.8, 1.5), glm::dvec3(1.2, 1.4, 1.1), glm::dvec3(1.6, 1.3, 1.9)};
  GatherStage stage = wall();
  for (std::size_t n = 0; n < 3; ++n) {
    Image8 photograph = stage.made.photographs[n];
    for (std::size_t i = 0; i < photograph.values.size(); ++i) {
      const double light = srgbToLinear(photograph.values[i] / 255.0) / kGains[n][int(i % 3)];
      photograph.values[i] = std::uint8_t(std::lround(255 * std::clamp(linearToSrgb(light), 0.0, 1.0)));
    }
    stage.setPhotograph(n, std::move(photograph));
    stage.made.scene.nodes[n].gain = kGains[n];
  }
  const Image8 even = wall().compose(kBetween).picture;
  FramePlan plan = stage.plan(kBetween);
  CHECK(psnr(stage.compose(plan).picture, even) > 45);
  plan.exposure = 1.0 / kGains[0];  // exposure of the first photograph
  const Camera own = stage.made.scene.nodes[0].camera;
  FramePlan adapted = stage.plan(own);
  adapted.exposure = plan.exposure;
  CHECK(psnr(stage.compose(adapted).picture, stage.made.photographs[0]) > 45);
  plan.settings.exposure = Exposure::off;
  CHECK(psnr(stage.compose(plan).picture, even) < 30);
}

TEST_CASE("gathered: a photograph much finer than the view is sampled from smaller mip levels") {
  GatherOptions options = wallOptions();
  options.planes[0].wavelength = 0.15;
  for (Camera& camera : options.cameras)
    camera.intrinsics = resized(camera.intrinsics, 3 * camera.intrinsics.width, 3 * camera.intrinsics.height);
  options.gridStep = 16;
  options.samplesPerAxis = 1;
  GatherStage stage = gatherStage(options);
  const Camera view = cameraAt({0.22, 0.17, 0.06}, 0.02, -0.01, 100, 75);
  const Composed levels = stage.compose(view);
  const Image8 truth = truthOf(stage, view);
  for (std::vector<Image8>& texture : stage.textures) texture.resize(1);
  CHECK(psnr(levels.picture, truth) > psnr(stage.compose(view).picture, truth) + 2);
  CHECK(psnr(levels.picture, truth) > 30);
}

TEST_CASE("gathered: a contradicted surface is outvoted unless confirmed") {
  const Block shard{30, 30, 110, 100};
  GatherOptions options = wallOptions();
  options.inverseDepth = [&](std::size_t node, glm::dvec2 pixel, double rho) {
    return node == 0 && shard.holds(pixel) ? 0.8 : rho;
  };
  const auto trusted = [&](Evidence evidence) {
    options.evidence = [&, evidence](std::size_t node, glm::dvec2 pixel) {
      return node == 0 && shard.holds(pixel) ? evidence : Evidence{};
    };
    return quality(gatherStage(options), kBetween);
  };
  const double exact = quality(wall(), kBetween), outvoted = trusted({0, 0.1f}), believed = trusted({3, 0.9f});
  CHECK(outvoted > exact - 5);
  CHECK(believed < outvoted - 3);
}

TEST_CASE("gathered: tiers distinguish confirmed, completed and filled depth") {
  GatherOptions options = wallOptions();
  options.evidence = [](std::size_t, glm::dvec2) { return Evidence{0, 0.1f}; };
  const GatherStage stage = gatherStage(options);
  CHECK(shareOf(stage.compose(kBetween), kTierConsistent) == 0);
  CHECK(shareOf(stage.compose(kBetween), kTierCompleted) > 0.9);
  CHECK(shareOf(wall().compose(kBetween), kTierConsistent) > 0.9);
}

TEST_CASE("gathered: both views of a stereo plan use the photographs of their midpoint") {
  const Camera left = kBetween;
  Camera right = kBetween;
  right.pose.position.x += 0.064;
  const FramePlan plan = wall().plan(std::vector{left, right});
  for (std::size_t v = 0; v < 2; ++v) {
    FramePlan alone = wall().plan(plan.views[v]);
    alone.photographs = plan.photographs;
    CHECK(wall().compose(plan, v).colour == wall().compose(alone).colour);
    CHECK(psnr(wall().compose(plan, v).picture, truthOf(wall(), plan.views[v])) > 33);
  }
}

TEST_CASE("gathered: the vote scale changes the image little") {
  FramePlan plan = wall().plan(kBetween);
  const Image8 half = wall().compose(plan).picture;
  plan.settings.voteScale = 1;
  const Image8 full = wall().compose(plan).picture;
  CHECK(psnr(half, full) > 30);
  CHECK(half != full);
  plan.settings.voteScale = 0.03;  // the vote has 4 × 3 pixels
  CHECK(shareOf(wall().compose(plan), kTierConsistent) > 0.5);
}

TEST_CASE("gathered: a camera step of a thousandth of the spacing changes the image little") {
  for (int i = 0; i < 6; ++i) {
    const Camera here = cameraAt({0.05 + 0.06 * i, 0.1 + 0.02 * i, 0.03 * i}, 0.02 * i, 0, 96, 72);
    Camera there = here;
    there.pose.position += 0.5e-3 * glm::dvec3(1, 0.5, -0.5);
    CHECK(difference(wall().compose(here).picture, wall().compose(there).picture, 0).meanAbsolute < 0.5);
  }
}

TEST_CASE("gathered: invalid plans are refused") {
  const auto refusal = [](auto&& spoil) {
    GatherStage stage = wall();
    FramePlan plan = stage.plan(kBetween);
    spoil(stage, plan);
    return errorOf([&] { stage.compose(plan); }).code();
  };
  CHECK(refusal([](GatherStage&, FramePlan& p) { p.settings.renderScale = 0.5; }) == ErrorCode::invalidInput);
  CHECK(refusal([](GatherStage&, FramePlan& p) { p.gather.spacing = 0; }) == ErrorCode::invalidInput);
  CHECK(refusal([](GatherStage&, FramePlan& p) { p.settings.gatherColours = 0; }) == ErrorCode::invalidInput);
  CHECK(refusal([](GatherStage&, FramePlan& p) { p.settings.gatherLayers = 3; }) == ErrorCode::invalidInput);
  CHECK(refusal([](GatherStage&, FramePlan& p) { p.photographs[1].node = 7; }) == ErrorCode::invalidInput);
  CHECK(refusal([](GatherStage&, FramePlan& p) { p.photographs[1].backdrop = 0; }) == ErrorCode::invalidInput);
  CHECK(refusal([](GatherStage& s, FramePlan&) { s.made.scene.backdrops[1].mesh.confirmations.clear(); }) ==
        ErrorCode::invalidInput);
  CHECK(refusal([](GatherStage& s, FramePlan&) { s.textures[2].clear(); }) == ErrorCode::invalidInput);
  CHECK(refusal([](GatherStage& s, FramePlan&) { s.depths[0] = {}; }) == ErrorCode::invalidInput);
}

TEST_CASE("an image is compared with the reference by colour, tier and depth") {
  Composed ref = wall().compose(kBetween);
  const double pixels = double(ref.picture.width) * ref.picture.height;
  ImageF depth = ref.opaqueInverseDepth;
  for (float& value : depth.values) value = 1 / value;
  std::ranges::fill(ref.supportMargin.values, 0.1f);
  const auto of = [&](const Image8& image) { return compareGathered(ref, image, depth); };
  const GatherComparison same = of(ref.picture);
  CHECK(same.differing == 0);
  CHECK(same.excused == 0);
  CHECK(same.wrongDepth == 0);

  Image8 image = ref.picture;
  image.pixel(50, 40)[1] ^= 16;                     // changed colour
  image.pixel(60, 40)[3] = 255 - 64 * kTierFilled;  // changed tier
  image.pixel(70, 40)[0] =
      std::uint8_t(image.pixel(70, 40)[0] < 128 ? image.pixel(70, 40)[0] + 1 : image.pixel(70, 40)[0] - 1);  // rounding
  CHECK(of(image).differing == Approx(2 / pixels));
  ref.supportMargin.pixel(50, 40)[0] = 1e-5f;
  CHECK(of(image).differing == Approx(1 / pixels));
  CHECK(of(image).excused == Approx(1 / pixels));
  CHECK(of(image).isExcusable());
  std::ranges::fill(ref.supportMargin.values, 0.0f);
  CHECK_FALSE(of(Image8(ref.picture.width, ref.picture.height, 4, 0)).isExcusable());
  depth.pixel(10, 10)[0] *= 1.1f;
  depth.pixel(50, 40)[0] *= 1.1f;  // excused, because its colour differs
  CHECK(of(image).wrongDepth == Approx(1 / pixels));
}
