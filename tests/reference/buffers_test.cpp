// SPDX-License-Identifier: Apache-2.0
// Data buffers of a frame (BufferTargets): relations between their values, and comparison with the reference.
#include <catch2/catch.hpp>
#include <cmath>

#include "reference/cell_pass_reference.h"
#include "reference/stage.h"
#include "support/gpu.h"

using namespace ibr;
using namespace ibr::test;

namespace {

VkExtent2D extentOf(const FramePlan& plan) {
  const Intrinsics& k = plan.views[0].intrinsics;
  return {std::uint32_t(k.width), std::uint32_t(k.height)};
}

// Counts values that BufferTargets does not document. Depth and uncertainty may be infinite; NaN is never allowed.
std::size_t undocumented(const FrameBuffers& buffers) {
  std::size_t count = 0;
  for (int y = 0; y < buffers.surface.height; ++y)
    for (int x = 0; x < buffers.surface.width; ++x) {
      const auto surface = buffers.surface.pixel(x, y), confidence = buffers.confidence.pixel(x, y);
      for (const float infinite : {surface[0], confidence[1]}) count += !(infinite >= 0);
      for (const float value : buffers.weights.pixel(x, y)) count += !std::isfinite(value);
      for (const float value : {surface[1], surface[2], surface[3], confidence[0]}) count += !std::isfinite(value);
    }
  return count;
}

// One renderer for many frames, because creating its pipelines is slow.
class Recorder {
 public:
  explicit Recorder(const Stage& stage)
      : renderer_(testDevice(), stage.gpuScene(),
                  {.maxExtent = {400, 360},
                   .fill = false,
                   .colour = ColourSupport::ours,
                   .bufferScene = &stage.scene(),
                   .orders = {DrawOrder::ours, DrawOrder::paper},
                   .blends = {BlendMode::blend, BlendMode::dither, BlendMode::mixed}}) {}

  FrameBuffers buffers(const FramePlan& plan) const {
    OffscreenBuffers offscreen(testDevice(), extentOf(plan));
    FrameBuffers read = offscreen.render(
        [&](VkCommandBuffer commands) { renderer_.recordBuffers(commands, plan, 0, offscreen.targets()); });
    CHECK(undocumented(read) == 0);
    return read;
  }
  Image8 picture(const FramePlan& plan) const {
    Offscreen offscreen(testDevice(), extentOf(plan));
    return offscreen.render([&](VkCommandBuffer commands) { renderer_.record(commands, plan, offscreen.target()); });
  }

 private:
  Renderer renderer_;
};

// Two cells. Made once, because generating them takes longer than rendering an image.
const SyntheticScene& richScene() {
  static const SyntheticScene place = [] {
    SyntheticScene made = twoCells();
    for (std::size_t i = 0; i < made.photographs.size(); ++i)  // all different, so that colour spread is not zero
      for (std::uint8_t& value : made.photographs[i].values) value = std::uint8_t(value / 2 + 30 * i);
    for (Cell& cell : made.scene.cells)
      for (std::size_t p = 0; p < cell.mesh.vertexCount(); ++p)
        cell.mesh.uncertainty[p] = 0.01f * cell.mesh.inverseDistance[p] * float(1 + p % 5);
    return made;
  }();
  return place;
}

}  // namespace

TEST_CASE("buffers equal the reference implementation") {
  const Stage stage(testDevice(), richScene());
  const Recorder recorder(stage);
  for (const BlendMode blend : {BlendMode::blend, BlendMode::dither}) {
    RenderSettings settings = withTiers();
    settings.blend = blend;
    const FramePlan plan = stage.plan(cameraAt({0.6, 0.4, 0.2}, 0.1), settings);
    const FrameBuffers buffers = recorder.buffers(plan);
    const reference::RenderedImage ref = reference::render(stage.scene(), stage.textures(), plan);
    std::size_t compared = 0, drawn = 0, wrong[6] = {};
    int tiers = 0, ranks = 0;
    for (int y = 0; y < ref.height; ++y)
      for (int x = 0; x < ref.width; ++x) {
        const std::size_t at = std::size_t(y) * std::size_t(ref.width) + std::size_t(x);
        if (!ref.safe[at]) continue;
        const reference::BufferValues& known = ref.known[at];
        const auto surface = buffers.surface.pixel(x, y), weights = buffers.weights.pixel(x, y),
                   confidence = buffers.confidence.pixel(x, y);
        ++compared;
        wrong[0] += float(known.tier) != surface[1];
        wrong[1] += float(known.rank) != surface[2];
        if (known.tier < 0) {
          wrong[2] += !std::isinf(surface[0]) || !std::isinf(confidence[1]) || weights[0] != 0;
          continue;
        }
        ++drawn;
        tiers |= 1 << known.tier;
        ranks |= 1 << known.rank;
        // Near a fold, the device may show the other of two triangles at almost equal depth.
        wrong[2] += !(std::abs(surface[0] - known.depth) <= 1e-3 * known.depth);
        wrong[3] += std::abs(surface[3] - known.extrapolation) > 1e-6;
        for (int i = 0; i < 4; ++i) wrong[4] += std::abs(weights[i] - known.weights[i]) > 1e-6;
        wrong[5] += std::abs(confidence[1] - known.uncertainty) > 1e-3 * known.uncertainty + 1e-9;
        const double tolerance = (2 + std::exp2(-8) * (ref.range[at] + ref.levelRange[at]) * 4) / 255;
        wrong[5] += std::abs(confidence[0] - known.spread) > tolerance;
      }
    CHECK(drawn > compared / 2);
    CHECK(tiers == 1 << kTierConsistent);
    CHECK(ranks >= 0b11);
    for (const std::size_t count : wrong) CHECK(double(count) <= 1e-3 * double(compared));
  }
}

TEST_CASE("targets receive finite values from any position and with any settings", "[P4]") {
  const Stage stage(testDevice(), richScene());
  const Recorder recorder(stage);
  std::vector<Camera> views = {cameraAt({0.6, 0.4, 0.2}, 0.1),
                               cameraAt({1e3, 1e3, 1e3}),
                               cameraAt({0, 0, 1e9}),
                               cameraAt({0.6, 0.4, -7.999999}),
                               cameraAt({0.6, 0.4, -9}, std::numbers::pi),
                               cameraAt({0.6, 0.4, 0}, 0, std::numbers::pi / 2)};
  for (const double field : {1e-3, 3.1}) views.push_back(cameraAt({0.5, 0.4, 0.1}, 0, 0, 320, 240, field));
  for (const Node& node : stage.scene().nodes) views.push_back(node.camera);
  std::size_t drawn = 0;
  for (const BlendMode blend : {BlendMode::blend, BlendMode::dither, BlendMode::mixed})
    for (const Morph morph : {Morph::ours, Morph::paper})
      for (const Camera& view : views) {
        RenderSettings settings = withTiers();
        settings.blend = blend;
        settings.morph = morph;
        settings.extrapolationLimit = 1e6;
        const FrameBuffers buffers = recorder.buffers(stage.plan(view, settings));
        for (int x = 0; x < buffers.surface.width; ++x) drawn += buffers.surface.pixel(x, 120)[1] >= 0;
      }
  CHECK(drawn > views.size() * 320);  // a sixth of all pixels
}

TEST_CASE("at a photograph's pose buffers have its depth, its weight of 1 and no spread") {
  const Stage stage(testDevice(), richScene());
  const Recorder recorder(stage);
  for (std::size_t i : {0u, 1u, 3u}) {
    const Camera& camera = stage.scene().nodes[i].camera;
    const FramePlan plan = stage.plan(camera, withTiers());
    const Cell& main = stage.scene().cells[plan.cells[0].cell];
    const FrameBuffers buffers = recorder.buffers(plan);
    const ImageF truth = renderDepth(stage.place(), camera);
    std::size_t compared = 0, wrongDepth = 0, wrongWeights = 0, spread = 0;
    for (int y = 1; y + 1 < truth.height; ++y)
      for (int x = 1; x + 1 < truth.width; ++x) {
        const auto surface = buffers.surface.pixel(x, y), weights = buffers.weights.pixel(x, y);
        if (surface[1] != 0 || surface[2] != 0) continue;
        const float here = truth.pixel(x, y)[0];
        if (std::abs(truth.pixel(x - 1, y)[0] - here) > 0.5 || std::abs(truth.pixel(x + 1, y)[0] - here) > 0.5 ||
            std::abs(truth.pixel(x, y - 1)[0] - here) > 0.5 || std::abs(truth.pixel(x, y + 1)[0] - here) > 0.5)
          continue;
        ++compared;
        wrongDepth += !(std::abs(surface[0] - here) <= 2e-3 * here);
        for (std::size_t m = 0; m < main.members.size(); ++m)
          wrongWeights += std::abs(weights[m] - (main.members[m] == i ? 1.0f : 0.0f)) > 1e-5;
        spread += buffers.confidence.pixel(x, y)[0] > 1e-6;
      }
    INFO("photograph " << i);
    CHECK(compared > truth.values.size() / 10);
    CHECK(double(wrongDepth) <= 0.01 * double(compared));
    CHECK(wrongWeights == 0);
    CHECK(spread == 0);
  }
}

TEST_CASE("tiers equal the image's alpha in both draw orders, dissolving cells included") {
  const Stage stage(testDevice(), richScene());
  const Recorder recorder(stage);
  for (const DrawOrder order : {DrawOrder::ours, DrawOrder::paper})
    for (const Camera& view : {cameraAt({0.6, 0.4, 0.2}, 0.1), cameraAt({-1.9, 0.4, 0.2}, -0.1)}) {
      RenderSettings settings = withTiers();
      settings.order = order;
      const FramePlan plan = stage.plan(view, settings);
      const Image8 picture = recorder.picture(plan);
      const FrameBuffers buffers = recorder.buffers(plan);
      std::size_t wrong = 0, drawn = 0;
      for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
          const int alpha = picture.pixel(x, y)[3];
          drawn += alpha > 0;
          wrong += (alpha == 0 ? -1.0f : float(255 - alpha) / 64.0f) != buffers.surface.pixel(x, y)[1];
        }
      CHECK(drawn > 0);
      CHECK(wrong == 0);
    }
}

TEST_CASE("buffers do not change the image of the same command buffer and have infinite depth") {
  SyntheticOptions options = place(2);
  options.atInfinity = true;
  const Stage stage(testDevice(), makeScene(options));
  RenderSettings settings;
  settings.maxTier = kTierFilled;
  const FramePlan plan = stage.plan(cameraAt({0.4, 0, 0}), settings);
  const Image8 expected = stage.render(plan);
  const Renderer renderer(testDevice(), stage.gpuScene(), {.maxExtent = {320, 240}, .bufferScene = &stage.scene()});
  Offscreen offscreen(testDevice(), {320, 240});
  OffscreenBuffers floats(testDevice(), {320, 240});
  for (int repeat = 0; repeat < 2; ++repeat) {
    const FrameBuffers buffers = floats.render([&](VkCommandBuffer commands) {
      renderer.record(commands, plan, offscreen.target());
      renderer.recordBuffers(commands, plan, 0, floats.targets());
    });
    CHECK(offscreen.render([](VkCommandBuffer) {}) == expected);
    for (int x = 0; x < 320; ++x) {
      CHECK(std::isinf(buffers.surface.pixel(x, 120)[0]));
      CHECK((buffers.surface.pixel(x, 120)[1] == 0 || buffers.surface.pixel(x, 120)[1] == 3));
    }
  }
}

TEST_CASE("buffers have the size of their targets at any render scale") {
  const Stage stage(testDevice(), makeScene(place(2)));
  RenderSettings settings;
  settings.renderScale = 0.5;
  const FramePlan plan = stage.plan(cameraAt({0.4, 0, 0}), settings);
  FramePlan whole = plan;
  whole.settings.renderScale = 1;
  RendererOptions options = optionsFor(settings, {320, 240});
  options.maxRenderScale = 1;
  options.bufferScene = &stage.scene();
  const Renderer renderer(testDevice(), stage.gpuScene(), options);
  Offscreen offscreen(testDevice(), {320, 240});
  OffscreenBuffers floats(testDevice(), {320, 240});
  const FrameBuffers scaled = floats.render([&](VkCommandBuffer commands) {
    renderer.record(commands, plan, offscreen.target());
    renderer.recordBuffers(commands, plan, 0, floats.targets());
  });
  CHECK(offscreen.render([](VkCommandBuffer) {}) == stage.render(plan));
  CHECK(scaled.surface ==
        floats.render([&](VkCommandBuffer commands) { renderer.recordBuffers(commands, whole, 0, floats.targets()); })
            .surface);
}

TEST_CASE("buffers and overlays are counted only if requested") {
  const Stage stage(testDevice(), richScene());
  const FramePlan plan = stage.plan(cameraAt({0.6, 0.4, 0.2}, 0.1), withTiers());
  const auto counters = [&](RendererOptions options) {
    options.maxExtent = {320, 240};
    return Renderer(testDevice(), stage.gpuScene(), options).count(plan);
  };
  const auto none = counters({}), buffers = counters({.bufferScene = &stage.scene()}),
             edges = counters({.overlays = {Overlay::wireframe}});
  CHECK(buffers.pipelines > none.pipelines);
  CHECK(buffers.workingBytes > none.workingBytes);
  CHECK(edges.pipelines > none.pipelines);
  CHECK(edges.workingBytes == none.workingBytes);
  CHECK((buffers.passes == none.passes && buffers.draws == none.draws));
}
