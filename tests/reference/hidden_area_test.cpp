// SPDX-License-Identifier: Apache-2.0
// Hidden area of a headset: hidden pixels cost nothing and show the background; all other pixels are unchanged.
#include <catch2/catch.hpp>
#include <cstring>
#include <limits>

#include "base/vulkan/gpu_image.h"
#include "gpu/draw/multiview.h"
#include "gpu/transfer/readback.h"
#include "ibr/error.h"
#include "reference/stage.h"
#include "support/error_of.h"
#include "support/gpu.h"

using namespace ibr;
using namespace ibr::test;
using Catch::Contains;

namespace {

using Triangles = std::array<std::vector<glm::vec2>, 2>;

constexpr VkExtent2D kExtent{192, 160};

// Two eyes with mirrored fields of view, canted.
std::vector<Camera> headset() {
  std::vector<Camera> views{cameraAt({0.57, 0.4, 0.2}, 0.12, 0.05), cameraAt({0.63, 0.4, 0.2}, 0.02, 0.05)};
  views[0].intrinsics = pinholeFromTangents(int(kExtent.width), int(kExtent.height), -0.6, 0.4, 0.45, -0.55);
  views[1].intrinsics = pinholeFromTangents(int(kExtent.width), int(kExtent.height), -0.4, 0.6, 0.45, -0.55);
  return views;
}

// Corners hidden by lenses, with the nose side. The masks differ between the views and have both orientations.
const Triangles kMasks{
    {{{-0.6f, 0.45f},
      {-0.25f, 0.45f},
      {-0.6f, 0.1f},
      {-0.6f, -0.55f},
      {-0.6f, -0.15f},
      {-0.2f, -0.55f},
      {0.4f, 0.45f},
      {0.4f, 0.22f},
      {0.05f, 0.45f}},
     {{0.6f, 0.45f}, {0.22f, 0.45f}, {0.6f, 0.05f}, {-0.4f, -0.65f}, {-0.4f, -0.1f}, {0.1f, -0.65f}}}};

double side(glm::dvec2 a, glm::dvec2 b, glm::dvec2 p) {
  return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

enum class Where { inside, outside, border };

// Class of a pixel by its centre. border: less than `margin` px from an edge's line, or beyond an end of the edge.
Where where(const Triangles& masks, const FramePlan& plan, std::size_t view, int x, int y, double margin) {
  const Intrinsics& k = plan.views[view].intrinsics;
  const glm::dvec2 at(x + 0.5, y + 0.5);
  Where result = Where::outside;
  for (std::size_t t = 0; t < masks[view].size(); t += 3) {
    std::array<glm::dvec2, 3> corner;
    for (std::size_t i = 0; i < 3; ++i) corner[i] = project(k, glm::dvec3(glm::dvec2(masks[view][t + i]), -1)).value();
    const double turn = side(corner[0], corner[1], corner[2]) > 0 ? 1 : -1;
    double least = 1e9;
    for (std::size_t i = 0; i < 3; ++i) {
      const glm::dvec2 a = corner[i], b = corner[(i + 1) % 3];
      least = std::min(least, turn * side(a, b, at) / glm::length(b - a));
    }
    if (std::abs(least) <= margin)
      result = Where::border;
    else if (least > 0)
      return Where::inside;
  }
  return result;
}

struct Shown {
  std::vector<Image8> pictures;
  std::vector<std::vector<float>> depths;
  Renderer::Counters counters;
};

Shown show(const Stage& stage, const FramePlan& plan, const Triangles& hidden, bool multiview, DepthTarget convention) {
  RendererOptions options = optionsFor(plan.settings, kExtent);
  options.maxViews = std::uint32_t(plan.views.size());
  options.orders = {DrawOrder::ours, DrawOrder::paper};
  options.depth = true;
  options.multiview = multiview;
  options.uncertaintyScene = &stage.scene();
  options.hiddenArea = hidden;
  const Renderer renderer(testDevice(), stage.gpuScene(), options);
  std::vector<Offscreen> offscreens;
  std::vector<GpuImage> depths;
  std::vector<Target> targets;
  for (std::size_t v = 0; v < plan.views.size(); ++v) {
    offscreens.emplace_back(testDevice(), kExtent);
    depths.emplace_back(
        testDevice(),
        GpuImageInfo{.format = VK_FORMAT_D32_SFLOAT,
                     .extent = kExtent,
                     .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
                     .aspect = VK_IMAGE_ASPECT_DEPTH_BIT},
        "caller's depth");
  }
  for (std::size_t v = 0; v < plan.views.size(); ++v) {
    Target& target = targets.emplace_back(offscreens[v].target());
    target.depth = convention;
    target.depth->image = depths[v].get();
    target.depth->view = depths[v].view();
  }
  Shown shown;
  for (std::size_t v = 0; v < plan.views.size(); ++v)
    shown.pictures.push_back(offscreens[v].render([&](VkCommandBuffer commands) {
      if (v == 0) renderer.record(commands, plan, targets);
    }));
  for (const GpuImage& depth : depths) {
    const std::vector<std::byte> bytes =
        readImage(testDevice(), depth.get(), kExtent, 4, use::kDepthAttachment, VK_IMAGE_ASPECT_DEPTH_BIT);
    std::memcpy(shown.depths.emplace_back(bytes.size() / 4).data(), bytes.data(), bytes.size());
  }
  shown.counters = renderer.count(plan);
  return shown;
}

// Made once, because generating the scene takes longer than rendering an image.
const SyntheticScene& shownScene() {
  static const SyntheticScene place = twoCells();
  return place;
}

FramePlan planned(const RenderSettings& settings) {
  return planFrame(shownScene().scene, sceneBounds(shownScene().scene), {headset(), settings});
}

RenderSettings with(auto change) {
  RenderSettings settings = withTiers();
  settings.background = {1.0f, 0.2f, 0.6f};
  change(settings);
  return settings;
}

}  // namespace

TEST_CASE("pixels in the hidden area show the background at far depth, and other pixels are unchanged", "[multiview]") {
  const Stage stage(testDevice(), shownScene());
  struct Row {
    const char* name;
    RenderSettings settings;
    bool multiview = false, reversed = false, mixed = false;
  };
  const std::vector<Row> rows{
      {"plain", with([](auto&) {})},
      {"both at once", with([](auto& s) { s.blend = BlendMode::mixed; }), true, true},
      {"colours mapped", with([](auto& s) { s.colourMapping = ColourMapping::ours; }), true},
      {"a switch", with([](auto&) {}), false, false, true},
      {"a switch, at once", with([](auto&) {}), true, false, true},
      {"a floor", with([](auto& s) { s.floor = Floor{.height = -1.5}; })},
      {"wireframe", with([](auto& s) { s.overlay = Overlay::wireframe; }), true},
      {"overlap", with([](auto& s) { s.overlay = Overlay::overlap; }), false, true},
  };
  for (const Row& row : rows) {
    INFO(row.name);
    FramePlan plan = planned(row.settings);
    if (row.mixed) {
      plan.previous = plan.cells;
      std::swap(plan.previous[0], plan.previous[1]);
      plan.previousWeight = 0.4;
    }
    const DepthTarget convention{.nearPlane = 0.1, .reversed = row.reversed};
    const Shown all = show(stage, plan, {}, row.multiview, convention);
    const Shown seen = show(stage, plan, kMasks, row.multiview, convention);
    for (std::size_t view = 0; view < 2; ++view) {
      INFO("view " << view);
      std::size_t inside = 0, outside = 0, drawn = 0, wrong = 0, border = 0;
      for (int y = 0; y < int(kExtent.height); ++y)
        for (int x = 0; x < int(kExtent.width); ++x) {
          const auto before = all.pictures[view].pixel(x, y), now = seen.pictures[view].pixel(x, y);
          const std::size_t at = std::size_t(y) * kExtent.width + std::size_t(x);
          const bool same = std::ranges::equal(before, now) && all.depths[view][at] == seen.depths[view][at];
          const bool isBackground = now[0] == 255 && now[1] == 51 && now[2] == 153 && now[3] == 0 &&
                                    seen.depths[view][at] == (row.reversed ? 0.0f : 1.0f);
          switch (where(kMasks, plan, view, x, y, 1e-3)) {
            case Where::inside:
              ++inside;
              drawn += before[3] != 0;
              wrong += !isBackground;
              break;
            case Where::outside:
              ++outside;
              wrong += !same;
              break;
            case Where::border:
              ++border;
              wrong += !isBackground && !same;
              break;
          }
        }
      CHECK(inside > 2000);
      CHECK(outside > 15000);
      CHECK(drawn > 1000);  // hidden pixels drawn without a mask
      CHECK(border < 100);
      CHECK(wrong == 0);
    }
  }
}

TEST_CASE("at any render scale the hidden area does not blend with visible pixels") {
  SyntheticScene grey = shownScene();
  for (Image8& photograph : grey.photographs) std::ranges::fill(photograph.values, std::uint8_t(200));
  const Stage stage(testDevice(), grey);
  for (const double scale : {0.5, 1.6}) {
    INFO("scale " << scale);
    // With filling, only hidden pixels show the background.
    const FramePlan plan = planned(with([&](auto& s) {
      s.renderScale = scale;
      s.maxTier = kTierFilled;
    }));
    const Shown seen = show(stage, plan, kMasks, false, {});
    std::size_t hidden = 0, wrong = 0, shifted = 0;
    for (std::size_t view = 0; view < 2; ++view)
      for (int y = 0; y < int(kExtent.height); ++y)
        for (int x = 0; x < int(kExtent.width); ++x) {
          const auto pixel = seen.pictures[view].pixel(x, y);
          const bool isHidden = pixel[3] == 0;
          hidden += isHidden;
          const std::array<int, 3> expected = isHidden ? std::array{255, 51, 153} : std::array{200, 200, 200};
          for (std::size_t c = 0; c < 3; ++c) wrong += std::abs(pixel[c] - expected[c]) > 1;
          const Where place = where(kMasks, plan, view, x, y, 1.5);  // canvas pixels may be larger
          shifted += isHidden ? place == Where::outside : place == Where::inside;
        }
    CHECK(hidden > 4000);
    CHECK(wrong == 0);
    CHECK(shifted == 0);
  }
}

TEST_CASE("the hidden area may cover all, none or one of the views, or lie outside the image", "[multiview]") {
  const Stage stage(testDevice(), shownScene());
  const FramePlan plan = planned(with([](auto&) {}));
  const Shown all = show(stage, plan, {}, true, {});
  const std::vector<glm::vec2> everything{{-1e6f, -1e6f}, {1e6f, -1e6f}, {0.0f, 1e6f}};
  const Shown none = show(stage, plan, {{everything, everything}}, true, {});
  for (std::size_t view = 0; view < 2; ++view) {
    std::size_t wrong = 0;
    for (int y = 0; y < int(kExtent.height); ++y)
      for (int x = 0; x < int(kExtent.width); ++x) wrong += none.pictures[view].pixel(x, y)[1] != 51;
    CHECK(wrong == 0);
    CHECK(std::ranges::count(none.depths[view], 1.0f) == kExtent.width * kExtent.height);
  }
  for (const bool multiview : {false, true}) {
    const Shown right = show(stage, plan, {{{}, everything}}, multiview, {});
    CHECK((right.pictures[0] == all.pictures[0] && right.depths[0] == all.depths[0]));
    CHECK((right.pictures[1] == none.pictures[1] && right.depths[1] == none.depths[1]));
    const Shown left = show(stage, plan, {{everything, {}}}, multiview, {});
    CHECK((left.pictures[0] == none.pictures[0] && left.depths[0] == none.depths[0]));
    CHECK((left.pictures[1] == all.pictures[1] && left.depths[1] == all.depths[1]));
  }
  const std::vector<glm::vec2> beside{{2, 0}, {3, 0}, {2, 5}}, flat{{-1, 0}, {0, 0}, {1, 0}};
  const Shown same = show(stage, plan, {{beside, flat}}, true, {});
  CHECK((same.pictures == all.pictures && same.depths == all.depths));
}

TEST_CASE("with skipHiddenArea off the whole image is drawn at any render scale") {
  const Stage stage(testDevice(), shownScene());
  for (const double scale : {1.0, 0.7})
    for (const int tier : {kTierCompleted, kTierFilled}) {
      const FramePlan plan = planned(with([&](auto& s) {
        s.skipHiddenArea = false;
        s.renderScale = scale;
        s.maxTier = tier;
      }));
      const Shown kept = show(stage, plan, kMasks, true, {}), whole = show(stage, plan, {}, true, {});
      CHECK((kept.pictures == whole.pictures));
      CHECK((kept.depths == whole.depths));
    }
}

TEST_CASE("the hidden area applies to single views and is ignored by the paper's draw order") {
  const Stage stage(testDevice(), shownScene());
  const RenderSettings paper = with([](auto& s) {
    s.order = DrawOrder::paper;
    s.maxTier = kTierFilled;  // fills holes of the scene
  });
  CHECK((show(stage, planned(paper), kMasks, true, {}).pictures == show(stage, planned(paper), {}, true, {}).pictures));
  FramePlan plan = planned(with([](auto&) {}));
  const Image8 left = show(stage, plan, kMasks, false, {}).pictures[0];
  plan.views.pop_back();
  CHECK((show(stage, plan, kMasks, false, {}).pictures[0] == left));
}

TEST_CASE("a hidden area costs a pipeline and a draw, and an empty one nothing", "[multiview]") {
  const Stage stage(testDevice(), shownScene());
  const FramePlan plan = planned(with([](auto&) {}));
  const bool atOnce = multiviewWorks(testDevice());
  for (const bool multiview : {false, true}) {
    const auto none = show(stage, plan, {}, multiview, {}).counters,
               some = show(stage, plan, kMasks, multiview, {}).counters;
    CHECK(none.bytes.hiddenArea == 0);
    CHECK(some.bytes.hiddenArea == 15 * 12);
    CHECK(some.pipelines == none.pipelines + (multiview && atOnce ? 2 : 1));
    CHECK(some.draws == none.draws + (multiview && atOnce ? 1 : 2));
    CHECK(some.triangles == none.triangles + 5);
    CHECK(some.passes == none.passes);
    CHECK(some.workingBytes == none.workingBytes + 15 * 12);
  }
}

TEST_CASE("invalid hidden areas are refused by field and index") {
  const Stage stage(testDevice(), shownScene());
  const auto refusal = [&](const Triangles& hidden) {
    const Error error = errorOf([&] {
      RendererOptions options{.maxExtent = kExtent};
      options.hiddenArea = hidden;
      const Renderer renderer(testDevice(), stage.gpuScene(), options);
    });
    CHECK(error.code() == ErrorCode::invalidInput);
    return std::string(error.what());
  };
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
  CHECK_THAT(refusal({{{{0, 0}, {1, 0}}, {}}}), Contains("hiddenArea[0]") && Contains("2"));
  CHECK_THAT(refusal({{{}, {{0, 0}, {1, 0}, {0, 1}, {1, 1}}}}), Contains("hiddenArea[1]") && Contains("4"));
  for (const float wrong : {kNan, kInfinity, -kInfinity, 1.1e6f, -3e38f}) {
    CHECK_THAT(refusal({{{{0, 0}, {1, wrong}, {0, 1}}, {}}}), Contains("hiddenArea[0][1]"));
    CHECK_THAT(refusal({{{}, {{0, 0}, {1, 0}, {wrong, 1}}}}), Contains("hiddenArea[1][2]"));
  }
}
