// SPDX-License-Identifier: Apache-2.0
// Filled pixels (tier 3): push–pull filling.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "reference/fill.h"
#include "reference/stage.h"
#include "support/gpu.h"

using namespace ibr;
using namespace ibr::test;
using ibr::reference::FillLevel;

namespace {

// Reference of a filled image: the canvas's colours from 0 to 1, with holes (alpha 0) filled.
FillLevel<glm::dvec3> filled(const Image8& canvas) {
  FillLevel<glm::dvec3> level(canvas.width, canvas.height);
  for (int y = 0; y < canvas.height; ++y)
    for (int x = 0; x < canvas.width; ++x) {
      const auto p = canvas.pixel(x, y);
      level.value[level.index(x, y)] = glm::dvec3(p[0], p[1], p[2]) / 255.0;
      level.weight[level.index(x, y)] = p[3] != 0;
    }
  CHECK(ibr::reference::fill(level));
  return level;
}

}  // namespace

TEST_CASE("holes are filled like in the reference implementation, and other pixels are unchanged") {
  const Stage stage(testDevice(), makeScene(place(3)));
  for (const Camera& view : {cameraAt({0.4, 0.25, 0.1}), cameraAt({0.4, 0.25, 0.1}, 0.4, 0, 333, 201),
                             cameraAt({0.2, 0.1, 0}, 0, 0, 64, 1), cameraAt({0.2, 0.1, 0}, 0, 0, 1, 64)}) {
    RenderSettings settings = withTiers();
    const Image8 empty = stage.render(view, settings);
    settings.maxTier = kTierFilled;
    const Image8 picture = stage.render(view, settings);
    const FillLevel<glm::dvec3> ref = filled(empty);
    int wrong = 0, holes = 0;
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        const auto before = empty.pixel(x, y), after = picture.pixel(x, y);
        const bool hole = before[3] == 0;
        holes += hole;
        wrong += after[3] != (hole ? 63 : before[3]);
        // Tolerance for half floats and 8-bit filter weights, accumulated over the levels.
        for (std::size_t c = 0; c < 3; ++c)
          wrong += std::abs(after[c] - 255 * ref.value[ref.index(x, y)][int(c)]) > (hole ? 3.0 : 0.5);
      }
    INFO(picture.width << "x" << picture.height);
    CHECK(holes > 0);
    CHECK(wrong == 0);
  }
}

TEST_CASE("filling an image without holes or without known pixels does nothing") {
  FillLevel<double> level(5, 3);
  CHECK_FALSE(ibr::reference::fill(level));
  CHECK(std::ranges::all_of(level.value, [](double value) { return value == 0; }));
  std::ranges::fill(level.weight, 1.0);
  level.value[1] = 3;
  CHECK_FALSE(ibr::reference::fill(level));
  level.weight[0] = 0;
  CHECK(ibr::reference::fill(level));
  CHECK(level.value[0] == Approx(1));  // mean of the three neighbours 3, 0, 0
  CHECK(level.value[1] == 3);
}

TEST_CASE("pixels of the hidden area are not filled and do not contribute to filled pixels") {
  const Stage stage(testDevice(), makeScene(place(3)));
  const Camera view = cameraAt({0.4, 0.25, 0.1}, 0.4);
  const auto rendered = [&](int maxTier) {
    RenderSettings settings = withTiers();
    settings.maxTier = maxTier;
    settings.background = {0, 0.4f, 1};
    RendererOptions options = optionsFor(settings, {320, 240});
    // The hidden area covers half of the drawn pixels and half of the holes.
    options.hiddenArea[0] = {{-9, 0}, {9, 0}, {0, 9}};
    const Renderer renderer(testDevice(), stage.gpuScene(), options);
    Offscreen offscreen(testDevice(), {320, 240});
    const FramePlan plan = stage.plan(view, settings);
    return offscreen.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, offscreen.target()); });
  };
  const Image8 empty = rendered(kTierCompleted), picture = rendered(kTierFilled);
  const FillLevel<glm::dvec3> ref = filled(empty);
  int wrong = 0, holes = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const auto pixel = picture.pixel(x, y);
      const bool hidden = y < 120, hole = !hidden && empty.pixel(x, y)[3] == 0;
      holes += hole;
      wrong += hidden != (pixel[3] == 0) || hole != (pixel[3] == 63);
      for (std::size_t c = 0; c < 3; ++c)
        wrong += hidden ? pixel[c] != std::array{0, 102, 255}[c]
                        : std::abs(pixel[c] - 255 * ref.value[ref.index(x, y)][int(c)]) > (hole ? 3.0 : 0.5);
    }
  CHECK(holes > 1000);
  CHECK(wrong == 0);
}

TEST_CASE("an empty image shows the background") {
  const Stage stage(testDevice(), makeScene(place(2)));
  RenderSettings settings = withTiers();
  settings.maxTier = kTierFilled;
  settings.background = {1, 0, 0};
  const Image8 picture = stage.render(cameraAt({0.4, 0.1, 0}, 3.0), settings);
  CHECK(picture.pixel(10, 10)[0] == 255);
  CHECK(picture.pixel(10, 10)[1] == 0);
  CHECK(picture.pixel(10, 10)[3] == 0);
}

TEST_CASE("a frame has the counted cost") {
  SyntheticOptions two = place(3);
  two.cells = {{0, 1, 2}, {2, 1, 0}};
  const Stage stage(testDevice(), makeScene(two));
  GpuScene gpuScene(testDevice(), stage.scene(), {.source = stage.source()});
  RendererOptions options{.maxExtent = {320, 240}, .colour = ColourSupport::off};
  options.formats = {VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_B8G8R8A8_SRGB};
  options.blends = {BlendMode::blend, BlendMode::dither};
  const Renderer whole(testDevice(), gpuScene, options);
  options.crossFadeOrders = options.fill = false;
  const Renderer bare(testDevice(), gpuScene, options);
  RenderSettings filling;
  filling.maxTier = kTierFilled;
  const FramePlan plan = stage.plan(cameraAt({0.4, 0.25, 0.1}), filling);
  REQUIRE(plan.cells.size() == 2);
  const std::uint64_t triangles =
      stage.scene().cells[0].mesh.triangles.size() + stage.scene().cells[1].mesh.triangles.size();
  // Cells of three members: with and without dissolving, blended and dithered. Two target formats, each with and
  // without mixing and filling. Three pipelines of the fill pass.
  const Renderer::Counters w = whole.count(plan), b = bare.count(plan);
  CHECK(b.pipelines == 4 + 2);
  CHECK(w.pipelines == 4 + 2 * 4 + 3);
  CHECK(b.passes == 2);
  CHECK(b.draws == 3);
  CHECK(b.dispatches == 0);
  CHECK(b.triangles == triangles + 1);
  CHECK(w.dispatches == 2 * 9 - 1);  // nine levels, from 160×120 to 1×1
  CHECK(w.triangles == b.triangles);
  CHECK(b.workingBytes >= 320 * 240 * 8);
  CHECK(w.workingBytes > 2 * b.workingBytes);
  FramePlan mixing = plan;
  mixing.previous = plan.cells;
  mixing.previousWeight = 0.5;
  CHECK(whole.count(mixing).passes == 3);
  CHECK(whole.count(mixing).triangles == 2 * triangles + 1);
  CHECK(bare.count(mixing).passes == 2);
}
