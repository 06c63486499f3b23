// SPDX-License-Identifier: Apache-2.0
// Masked photographs on the GPU: masked pixels show the other members, or the surface behind them.
#include <algorithm>

#include "ibr/requirements.h"
#include "reference/compare_pictures.h"

using namespace ibr;
using namespace ibr::test;

namespace {

struct Block {
  int left, top, right, bottom;
};

// Masks blocks of a photograph and fills them with magenta, which makes leaks visible.
void maskBlocks(SyntheticScene& place, std::size_t node, const std::vector<Block>& blocks) {
  const Image8& rgb = place.photographs[node];
  Image8 masked(rgb.width, rgb.height, 4, 255);
  for (int y = 0; y < rgb.height; ++y)
    for (int x = 0; x < rgb.width; ++x) {
      std::ranges::copy(rgb.pixel(x, y), masked.pixel(x, y).begin());
      for (const Block& b : blocks)
        if (x >= b.left && x < b.right && y >= b.top && y < b.bottom) {
          constexpr std::uint8_t kGone[]{255, 0, 255, 0};
          std::ranges::copy(kGone, masked.pixel(x, y).begin());
        }
    }
  place.photographs[node] = masked;
  place.scene.nodes[node].maskFile = "masks/" + place.scene.nodes[node].name + ".png";
}

// The second photograph has a large masked block, the first a single pixel, the third two large blocks. In one region
// all photographs are masked.
SyntheticScene maskedPlace(std::size_t members) {
  SyntheticScene made = makeScene(place(members));
  maskBlocks(made, 0, {{100, 80, 170, 150}, {40, 60, 41, 61}});
  maskBlocks(made, 1, {{60, 120, 170, 230}});
  if (members > 2) maskBlocks(made, 2, {{130, 120, 220, 220}, {300, 20, 330, 60}});
  return made;
}

}  // namespace

TEST_CASE("masked members equal the reference implementation") {
  for (const std::size_t members : {2u, 3u, 4u}) {
    const Stage stage(testDevice(), maskedPlace(members));
    for (const BlendMode blend : {BlendMode::blend, BlendMode::dither, BlendMode::mixed})
      for (const Morph morph : {Morph::ours, Morph::paper}) {
        RenderSettings settings = withTiers();
        settings.blend = blend;
        settings.morph = morph;
        INFO(members << " members, blend " << int(blend) << ", morph " << int(morph));
        compareWithReference(stage, stage.plan(cameraAt({0.4, 0.25, 0.1}, 0.03), settings));
      }
  }
}

TEST_CASE("regions masked in all photographs stay empty with every preset") {
  const Stage stage(testDevice(), maskedPlace(2)), unmasked(testDevice(), makeScene(place(2)));
  const Camera view = cameraAt({0.4, 0.25, 0.1}, 0.03);
  RenderSettings settings = withTiers();
  settings.maxTier = kTierCompleted;
  const auto holes = [](const Image8& picture) {
    std::size_t count = 0;
    for (std::size_t a = 3; a < picture.values.size(); a += 4) count += picture.values[a] == 0;
    return count;
  };
  const std::size_t unfilled = holes(stage.render(view, settings));
  CHECK(unfilled > 1000);
  for (const Preset name : {Preset::balanced, Preset::reference}) {
    settings = preset(name, DeviceKind::software);
    settings.alpha = AlphaContent::tier;
    CHECK(holes(stage.render(view, settings)) == unfilled);
  }
  CHECK(holes(unmasked.render(view, settings)) == 0);
}

TEST_CASE("at a masked photograph's pose other photographs of weight 0 fill the mask") {
  SyntheticScene made = makeScene(place(2));
  maskBlocks(made, 0, {{120, 90, 200, 150}});
  const Stage stage(testDevice(), made);
  const Camera own = made.scene.nodes[0].camera;
  const FramePlan plan = stage.plan(own, withTiers());
  REQUIRE(plan.cells[0].view[0].blend[0] == 1);
  const Stage whole(testDevice(), makeScene(place(2)));
  const Image8 picture = stage.render(plan), unmasked = whole.render(own, withTiers());
  std::size_t shown = 0, empty = 0, wrong = 0;
  for (int y = 92; y < 148; ++y)
    for (int x = 122; x < 198; ++x) {
      if (unmasked.pixel(x, y)[3] == 0) continue;
      ++shown;
      empty += picture.pixel(x, y)[3] == 0;
      wrong += std::abs(picture.pixel(x, y)[0] - unmasked.pixel(x, y)[0]) > 40;
    }
  CHECK(shown > 1000);
  CHECK(empty == 0);
  CHECK(wrong < shown / 50);  // leaked magenta would exceed this in nearly every pixel
  compareWithReference(stage, plan);
}

TEST_CASE("cells show through masks of cells in front") {
  SyntheticScene made = twoCells();
  maskBlocks(made, 0, {{0, 0, 200, 240}});
  maskBlocks(made, 1, {{0, 0, 240, 250}});
  maskBlocks(made, 2, {{50, 50, 250, 250}});
  const Stage stage(testDevice(), made);
  const FramePlan plan = stage.plan(cameraAt({0.5, 0.35, 0.1}, 0.02), withTiers());
  REQUIRE(plan.cells.size() == 2);
  compareWithReference(stage, plan);
}

TEST_CASE("a completely masked photograph is not shown") {
  SyntheticScene made = makeScene(place(2));
  maskBlocks(made, 1, {{0, 0, 1000, 1000}});
  const Stage stage(testDevice(), made);
  const FramePlan plan = stage.plan(cameraAt({0.5, 0, 0}), withTiers());
  compareWithReference(stage, plan);
  const Image8 picture = stage.render(plan);
  std::size_t magenta = 0;
  for (std::size_t p = 0; p < picture.values.size(); p += 4)
    magenta += picture.values[p] > 250 && picture.values[p + 1] < 5 && picture.values[p + 2] > 250;
  CHECK(magenta == 0);
}

TEST_CASE("masks with bicubic filtering and of panoramas equal the reference for photographs") {
  GpuSceneOptions cubic;
  cubic.filter = TextureFilter::bicubic;
  const Stage sharp(testDevice(), maskedPlace(3), cubic);
  compareWithReference(sharp, sharp.plan(cameraAt({0.4, 0.25, 0.1}, 0.03, 0, 480, 360, 0.5), withTiers()));

  SyntheticOptions options;
  options.cameras = {
      {{CameraModel::equirectangular, 512, 256}, {}},
      {{CameraModel::equirectangular, 640, 320}, {{1, 0, 0.1}, glm::angleAxis(2.0, glm::dvec3(0, 1, 0))}}};
  options.planes = roomPlanes({-3, -1.5, -2.5}, {4, 1.9, 3.5}, 0.5);
  options.surfaceStep = 0.8;
  options.samplesPerAxis = 2;
  SyntheticScene made = makeScene(options);
  maskBlocks(made, 0, {{200, 60, 320, 250}});
  maskBlocks(made, 1, {{0, 100, 640, 160}});
  const Stage round(testDevice(), made);
  compareWithReference(round, round.plan(cameraAt({0.4, 0.1, 0.2}, 0.3, -0.9, 160, 121, 1.3), withTiers()));
}

TEST_CASE("requirements count photographs with masks") {
  SyntheticScene made = makeScene(place(2));
  CHECK(requirementsOf(made.scene, {}).masked == 0);
  maskBlocks(made, 1, {{0, 0, 10, 10}});
  CHECK(requirementsOf(made.scene, {}).masked == 1);
  CHECK(isMasked(made.scene, made.scene.cells[0]));
  Cell alone = made.scene.cells[0];
  alone.members = {0};
  CHECK_FALSE(isMasked(made.scene, alone));
}
