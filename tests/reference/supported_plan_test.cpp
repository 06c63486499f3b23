// SPDX-License-Identifier: Apache-2.0
// Plans that a renderer does not support: supports() names the reason, and the background is drawn.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "reference/stage.h"
#include "render/exceeded_option.h"
#include "support/gpu.h"

using namespace ibr;
using namespace ibr::test;

namespace {

constexpr VkExtent2D kExtent{64, 48};

FramePlan smallPlan(const Stage& stage, const RenderSettings& settings = {}) {
  return stage.plan(cameraAt({0.4, 0.1, 0}, 0, 0, int(kExtent.width), int(kExtent.height)), settings);
}

bool isPlain(const Image8& image, std::array<int, 4> colour) {
  for (std::size_t p = 0; p < image.values.size(); p += 4)
    for (std::size_t c = 0; c < 4; ++c)
      if (std::abs(image.values[p + c] - colour[c]) > 1) return false;
  return true;
}

}  // namespace

TEST_CASE("the first field of the options that a plan exceeds is named") {
  const Stage stage(testDevice(), makeScene(place(2)));
  const FramePlan plain = smallPlan(stage);
  RendererOptions options = optionsFor({}, kExtent);
  options.dissolve = false;
  options.maxRenderScale = 0.5;
  options.compositions.push_back(Composition::gathered);
  using Change = std::function<void(FramePlan&)>;
  const std::vector<std::pair<std::string, Change>> changes{
      {"maxViews", [](FramePlan& p) { p.views.push_back(p.views[0]); }},
      {"maxViews", [](FramePlan& p) { p.views.clear(); }},
      {"maxExtent", [](FramePlan& p) { p.views[0].intrinsics.width = 65; }},
      {"maxExtent", [](FramePlan& p) { p.views[0].intrinsics.height = 49; }},
      {"orders", [](FramePlan& p) { p.settings.order = DrawOrder::paper; }},
      {"blends", [](FramePlan& p) { p.settings.blend = BlendMode::dither; }},
      {"compositions", [](FramePlan& p) { p.settings.composition = Composition::hybrid; }},
      {"gatherCandidates", [](FramePlan& p) { p.photographs.resize(13); }},
      {"gatherCandidates",
       [](FramePlan& p) {
         p.settings.composition = Composition::gathered;
         p.photographs.resize(13);
       }},
      {"maxRenderScale", [](FramePlan& p) { p.settings.renderScale = 0.75; }},
      {"colour", [](FramePlan& p) { p.settings.colourMapping = ColourMapping::ours; }},
      {"overlays", [](FramePlan& p) { p.settings.overlay = Overlay::tiers; }},
      {"floor", [](FramePlan& p) { p.settings.floor = Floor{}; }},
      {"dissolve", [](FramePlan& p) { p.cells[0].opacity = 0.5; }},
      {"dissolve",
       [](FramePlan& p) {
         p.fadingOut.push_back({p.cells[0], 0}), p.fadingOut[0].planned.opacity = 0.5;
       }},
  };
  FramePlan scaled = plain;
  scaled.settings.renderScale = 0.5;
  CHECK(exceededOption(scaled, options) == nullptr);
  for (const auto& [field, change] : changes) {
    FramePlan plan = scaled;
    change(plan);
    const char* exceeded = exceededOption(plan, options);
    CHECK(std::string(exceeded ? exceeded : "") == field);
  }
}

TEST_CASE("a gathered plan needs the numbers of colours and layers of its renderer and no larger vote") {
  const Stage stage(testDevice(), makeScene(place(2)));
  FramePlan plain = smallPlan(stage);
  plain.settings.composition = Composition::gathered;
  const RendererOptions options = optionsFor(plain.settings, kExtent);
  REQUIRE(exceededOption(plain, options) == nullptr);
  const auto exceeded = [&](const std::function<void(RenderSettings&)>& change) {
    FramePlan plan = plain;
    change(plan.settings);
    const char* field = exceededOption(plan, options);
    return std::string(field ? field : "");
  };
  CHECK(exceeded([](RenderSettings& s) { --s.gatherColours; }) == "gatherColours");
  CHECK(exceeded([](RenderSettings& s) { ++s.gatherColours; }) == "gatherColours");
  CHECK(exceeded([](RenderSettings& s) { s.gatherLayers = 3 - s.gatherLayers; }) == "gatherLayers");
  CHECK(exceeded([](RenderSettings& s) { s.voteScale *= 1.01; }) == "voteScale");
  CHECK(exceeded([](RenderSettings& s) { s.voteScale *= 0.5; }).empty());
}

TEST_CASE("colour support covers its colour mapping methods") {
  const Stage stage(testDevice(), makeScene(place(2)));
  FramePlan plan = smallPlan(stage);
  RendererOptions options = optionsFor({}, kExtent);
  const auto fits = [&](ColourMapping mapping, ColourSupport support) {
    plan.settings.colourMapping = mapping;
    options.colour = support;
    return exceededOption(plan, options) == nullptr;
  };
  for (const ColourMapping mapping :
       {ColourMapping::off, ColourMapping::ours, ColourMapping::paper, ColourMapping::paperRedraw}) {
    CHECK(fits(mapping, ColourSupport::off) == (mapping == ColourMapping::off));
    CHECK(fits(mapping, ColourSupport::ours) == (mapping <= ColourMapping::ours));
    CHECK(fits(mapping, ColourSupport::all));
  }
}

TEST_CASE("an unsupported plan shows its background at far depth in every format") {
  const Stage stage(testDevice(), makeScene(place(2)));
  const FramePlan good = smallPlan(stage);
  FramePlan bad = good;
  bad.settings.order = DrawOrder::paper;
  bad.settings.background = {1.0f, 0.0f, 128 / 255.0f};
  for (const VkFormat format : {VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_R8G8B8A8_SRGB}) {
    RendererOptions options = optionsFor({}, kExtent, format);
    options.depth = true;
    options.bufferScene = &stage.scene();
    const Renderer renderer(testDevice(), stage.gpuScene(), options);
    std::string why = "unchanged";
    CHECK(renderer.supports(good, &why));
    CHECK(why == "unchanged");
    CHECK_FALSE(renderer.supports(bad));
    CHECK_FALSE(renderer.supports(bad, &why));
    CHECK(why == "RendererOptions::orders");
    Offscreen offscreen(testDevice(), kExtent, format);
    const auto picture = [&](const FramePlan& plan) {
      return offscreen.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, offscreen.target()); });
    };
    CHECK(isPlain(picture(bad), {255, 0, 128, 255}));
    CHECK_FALSE(isPlain(picture(good), {0, 0, 0, 255}));  // later supported plans are drawn
    const VkFormat other = format == VK_FORMAT_R8G8B8A8_UNORM ? VK_FORMAT_R8G8B8A8_SRGB : VK_FORMAT_R8G8B8A8_UNORM;
    FramePlan plain = good;
    plain.settings.background = bad.settings.background;
    Offscreen undeclared(testDevice(), kExtent, other);
    CHECK(isPlain(
        undeclared.render([&](VkCommandBuffer commands) { renderer.record(commands, plain, undeclared.target()); }),
        {255, 0, 128, 255}));
    OffscreenBuffers floats(testDevice(), kExtent);
    const FrameBuffers buffers =
        floats.render([&](VkCommandBuffer commands) { renderer.recordBuffers(commands, bad, 0, floats.targets()); });
    const auto surface = buffers.surface.pixel(20, 30), confidence = buffers.confidence.pixel(20, 30);
    CHECK((std::isinf(surface[0]) && surface[1] == -1 && surface[2] == -1 && surface[3] == 0));
    CHECK((confidence[0] == 0 && std::isinf(confidence[1])));
    CHECK(std::ranges::all_of(buffers.weights.values, [](float w) { return w == 0; }));
  }
}
