// SPDX-License-Identifier: Apache-2.0
// Relations between images that need no reference image.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "ibr/metrics.h"
#include "reference/stage.h"
#include "support/gpu.h"

using namespace ibr;
using namespace ibr::test;

namespace {

// Mask of the drawn pixels in `picture`, shrunk by one pixel.
Image8 interior(const Image8& picture) {
  Image8 mask(picture.width, picture.height, 1);
  for (int y = 1; y + 1 < picture.height; ++y)
    for (int x = 1; x + 1 < picture.width; ++x) {
      bool drawn = true;
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) drawn &= picture.pixel(x + i, y + j)[3] != 0;
      mask.pixel(x, y)[0] = drawn;
    }
  return mask;
}

double share(const Image8& mask) {
  return double(std::count(mask.values.begin(), mask.values.end(), std::uint8_t(1))) / double(mask.values.size());
}

int largestDifference(const Image8& a, const Image8& b, const Image8& mask) {
  int largest = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x)
      if (mask.pixel(x, y)[0])
        for (std::size_t c = 0; c < 3; ++c) largest = std::max(largest, std::abs(a.pixel(x, y)[c] - b.pixel(x, y)[c]));
  return largest;
}

// Share of pixels that differ by more than one 8-bit level.
double differing(const Image8& a, const Image8& b) {
  return difference(a, b, 1).shareAbove;
}

}  // namespace

TEST_CASE("at a photograph's pose the image equals the photograph, for both morphs and blend modes") {
  for (std::size_t members : {2u, 3u, 4u}) {
    const Stage stage(testDevice(), makeScene(place(members)));
    for (std::size_t i = 0; i < members; ++i)
      for (Morph morph : {Morph::ours, Morph::paper})
        for (BlendMode blend : {BlendMode::blend, BlendMode::dither}) {
          RenderSettings settings = withTiers();
          settings.morph = morph;
          settings.blend = blend;
          const Image8 picture = stage.render(stage.scene().nodes[i].camera, settings);
          const Image8 mask = interior(picture);
          INFO("member " << i << " of " << members << ", morph " << int(morph) << ", blend " << int(blend));
          CHECK(share(mask) > 0.15);
          CHECK(largestDifference(picture, stage.place().photographs[i], mask) <= 1);
        }
  }
}

TEST_CASE("our morph is closer to the truth than the paper's inside, outside and off the span") {
  const Stage stage(testDevice(), makeScene(place(3)));
  struct Row {
    Camera view;
    double least;   // min. PSNR of our morph, dB; errors: sampling, and the board's border in the grid
    double margin;  // min. advantage of our morph over the paper's, dB
  };
  for (const Row& row :
       {Row{cameraAt({0.4, 0.3, 0.05}), 45, -6}, Row{cameraAt({1.5, -0.3, 0.1}), 40, 15},
        Row{cameraAt({0.4, 0.3, 0.9}, 0.1), 36, 15}, Row{cameraAt({-0.6, -0.5, -0.7}, -0.05, 0.1), 30, 10}}) {
    RenderSettings settings = withTiers();
    const Image8 truth = renderTruth(stage.place(), row.view);
    const Image8 ours = stage.render(row.view, settings);
    settings.morph = Morph::paper;
    const Image8 paper = stage.render(row.view, settings);
    CHECK(share(interior(ours)) > 0.3);
    CHECK(psnr(ours, truth, interior(ours)) > row.least);
    CHECK(psnr(ours, truth, interior(ours)) > psnr(paper, truth, interior(paper)) + row.margin);
  }
}

TEST_CASE("moving and turning the world does not change the image", "[P6]") {
  const SyntheticScene here = makeScene(place(3));
  const Camera view = cameraAt({0.42, 0.27, 0.13}, 0.04);
  const Image8 expected = Stage(testDevice(), here).render(view, withTiers());
  const glm::dvec3 offset(1e7, -8e6, 3e6);
  const glm::dquat turn = glm::angleAxis(2.1, glm::normalize(glm::dvec3(1, -2, 0.5)));
  auto moved = [&](Camera camera) {
    camera.pose = {offset + turn * camera.pose.position, glm::normalize(turn * camera.pose.rotation)};
    return camera;
  };
  SyntheticScene there = here;
  for (Node& node : there.scene.nodes) node.camera = moved(node.camera);
  const Image8 picture = Stage(testDevice(), there).render(moved(view), withTiers());
  // At that distance positions are rounded to 2 nm. A pixel on an edge may fall to the other side.
  CHECK(differing(picture, expected) < 2e-3);
  CHECK(psnr(picture, expected) > 50);
}

TEST_CASE("the order of cells, triangles, vertices and members does not change the image") {
  SyntheticOptions options = place(4);
  options.cells = {{0, 1, 2}, {1, 2, 3}, {0, 3}};
  const SyntheticScene sorted = makeScene(options);
  SyntheticScene shuffled = sorted;
  std::mt19937_64 random(11);
  std::shuffle(shuffled.scene.cells.begin(), shuffled.scene.cells.end(), random);
  for (Cell& cell : shuffled.scene.cells) {
    std::shuffle(cell.mesh.triangles.begin(), cell.mesh.triangles.end(), random);
    std::reverse(cell.mesh.inverseDistance.begin(), cell.mesh.inverseDistance.end());
    for (auto& match : cell.mesh.match) std::reverse(match.begin(), match.end());
    for (auto& ratio : cell.mesh.ratio) std::reverse(ratio.begin(), ratio.end());
    const auto last = std::uint32_t(cell.mesh.vertexCount() - 1);
    for (glm::uvec3& t : cell.mesh.triangles) t = {last - t.z, last - t.x, last - t.y};
  }
  const Stage a(testDevice(), sorted), b(testDevice(), shuffled);
  for (const Camera& view : {cameraAt({0.45, 0.3, 0.2}), cameraAt({1.2, 0.1, -0.3}, 0.1)})
    for (BlendMode blend : {BlendMode::blend, BlendMode::dither}) {
      RenderSettings settings = withTiers();
      settings.blend = blend;
      const Image8 first = a.render(view, settings), second = b.render(view, settings);
      // Corner order changes the order of a triangle's arithmetic, which affects only the last bits of interpolation.
      CHECK(differing(first, second) < 1e-3);
    }
  SyntheticScene reordered = sorted;
  for (Cell& cell : reordered.scene.cells) {
    std::reverse(cell.members.begin(), cell.members.end());
    std::reverse(cell.mesh.match.begin(), cell.mesh.match.end());
    std::reverse(cell.mesh.ratio.begin(), cell.mesh.ratio.end());
  }
  const Stage c(testDevice(), reordered);
  const Camera view = cameraAt({0.45, 0.3, 0.2});
  CHECK(differing(a.render(view, withTiers()), c.render(view, withTiers())) < 1e-3);
}

TEST_CASE("front to back with a depth test equals back to front without one") {
  SyntheticOptions options = place(4);
  options.cells = {{0, 1, 2}, {1, 2, 3}, {0, 3}};
  const Stage stage(testDevice(), makeScene(options));
  const Camera view = cameraAt({0.45, 0.3, 0.2});
  RenderSettings settings = withTiers();
  const Image8 ours = stage.render(view, settings);
  settings.order = DrawOrder::paper;
  // No mesh folds in this view, so depth inside a cell does not matter.
  CHECK(stage.render(view, settings).values == ours.values);
}

TEST_CASE("a folded mesh shows its near side") {
  // Far outside the cell, the board hides other parts of the wall than in the photographs.
  const Stage stage(testDevice(), makeScene(place(2)));
  const Camera view = cameraAt({-1.7, 0.1, -0.3}, -0.2);
  RenderSettings settings = withTiers();
  settings.extrapolationLimit = 10;
  const Image8 picture = stage.render(view, settings), truth = renderTruth(stage.place(), view);
  settings.order = DrawOrder::paper;
  const Image8 painted = stage.render(view, settings);
  CHECK(share(interior(picture)) > 0.2);
  CHECK(psnr(picture, truth, interior(picture)) > 26);
  CHECK(picture.values != painted.values);
}

TEST_CASE("every target format shows the same image") {
  const Stage stage(testDevice(), makeScene(place(2)));
  const FramePlan plan = stage.plan(cameraAt({0.4, 0.1, 0}), withTiers());
  const Image8 expected = stage.render(plan);
  CHECK(stage.render(plan, VK_FORMAT_B8G8R8A8_UNORM) == expected);
  for (VkFormat format : {VK_FORMAT_R8G8B8A8_SRGB, VK_FORMAT_B8G8R8A8_SRGB})
    CHECK(difference(stage.render(plan, format), expected, 0).largest <= 1);
  CHECK(Renderer::supports(VK_FORMAT_B8G8R8A8_SRGB));
  CHECK_FALSE(Renderer::supports(VK_FORMAT_R32_SFLOAT));
}

TEST_CASE("background and alpha follow the settings") {
  const Stage stage(testDevice(), makeScene(place(2)));
  RenderSettings settings;
  settings.background = {1.0f, 0.0f, 128 / 255.0f};
  const Image8 away = stage.render(cameraAt({0.4, 0.1, 0}, 3.0), settings);
  CHECK(
      std::all_of(away.values.begin(), away.values.begin() + 4, [](int v) { return v == 255 || v == 0 || v == 128; }));
  CHECK(away.pixel(5, 5)[0] == 255);
  CHECK(away.pixel(5, 5)[1] == 0);
  CHECK(away.pixel(5, 5)[2] == 128);
  CHECK(away.pixel(5, 5)[3] == 255);
  settings.alpha = AlphaContent::tier;
  CHECK(stage.render(cameraAt({0.4, 0.1, 0}, 3.0), settings).pixel(5, 5)[3] == 0);
  CHECK(stage.render(cameraAt({0.4, 0.1, 0}), settings).pixel(160, 120)[3] == 255);
}

TEST_CASE("an empty scene is drawn as background") {
  const Stage stage(testDevice(), makeScene(place(2)));
  const Camera view = cameraAt({0.4, 0.1, 0});
  const Image8 expected = stage.render(view);
  GpuScene nothing(testDevice(), Scene{});
  Renderer renderer(testDevice(), nothing, {{320, 240}});
  Offscreen offscreen(testDevice(), {320, 240});
  const FramePlan empty = planFrame(Scene{}, sceneBounds(Scene{}), {{view}, {}});
  const Image8 black =
      offscreen.render([&](VkCommandBuffer commands) { renderer.record(commands, empty, offscreen.target()); });
  CHECK(std::all_of(black.values.begin(), black.values.end() - 1, [](int v) { return v == 0 || v == 255; }));
  CHECK(stage.render(view) == expected);
  CHECK(stage.render(view) == stage.render(view));
}

TEST_CASE("textures of the wrong size or number are refused with the photograph's name") {
  const SyntheticScene place = makeScene(test::place(2));
  auto refused = [&](auto change) {
    const auto source = [&](const Scene&, std::size_t node, int firstLevel) {
      Texture texture = withoutLargestLevels(buildMips(place.photographs[node]), firstLevel);
      if (node == 1) change(texture);
      return texture;
    };
    CHECK_THROWS_WITH(GpuScene(testDevice(), place.scene, {.source = source}), Catch::Contains("view1"));
  };
  refused([](Texture& texture) { texture.levels.pop_back(); });
  refused([](Texture& texture) { ++texture.width; });
  refused([](Texture& texture) { texture.levels[0].pop_back(); });
}
