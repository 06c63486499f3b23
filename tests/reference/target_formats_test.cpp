// SPDX-License-Identifier: Apache-2.0
// Targets of all formats and encodings, compared with the 8-bit image and the transfer function in double precision.
#include <algorithm>
#include <catch2/catch.hpp>
#include <functional>
#include <optional>
#include <set>

#include "ibr/error.h"
#include "reference/stage.h"
#include "reference/stored_colours.h"
#include "support/error_of.h"
#include "support/gpu.h"

using namespace ibr;
using namespace ibr::test;

namespace {

constexpr VkExtent2D kExtent{160, 120};
constexpr TargetFormat kHalf{VK_FORMAT_R16G16B16A16_SFLOAT, Encoding::display};
constexpr TargetFormat kLinearHalf{VK_FORMAT_R16G16B16A16_SFLOAT, Encoding::linear};
constexpr TargetFormat kTenBits{VK_FORMAT_A2B10G10R10_UNORM_PACK32, Encoding::display};
constexpr TargetFormat kLinearTenBits{VK_FORMAT_A2B10G10R10_UNORM_PACK32, Encoding::linear};

// Made once, because generating the scene takes longer than rendering an image.
const SyntheticScene& shownScene() {
  static const SyntheticScene place = twoCells();
  return place;
}

Camera view(double yaw = 0) {
  return cameraAt({0.6, 0.45, 0.35}, yaw, 0, int(kExtent.width), int(kExtent.height));
}

// Settings with holes of a background that 8 bits store exactly.
RenderSettings settings() {
  RenderSettings made = withTiers();
  made.background = {51 / 255.0f, 1.0f, 10 / 255.0f};
  return made;
}

RendererOptions optionsOf(const FramePlan& plan) {
  RendererOptions options = optionsFor(plan.settings, kExtent);
  options.maxViews = std::uint32_t(plan.views.size());
  options.formats.assign(kWideFormats.begin(), kWideFormats.end());
  options.formats.push_back(VK_FORMAT_R8G8B8A8_UNORM);
  return options;
}

template <class T>
using Picture = Image<T> (Offscreen::*)(const std::function<void(VkCommandBuffer)>&);

template <class T>
Image<T> drawn(const Renderer& renderer, const FramePlan& plan, TargetFormat format, Picture<T> picture) {
  Offscreen offscreen(testDevice(), kExtent, format);
  return (offscreen.*picture)([&](VkCommandBuffer commands) { renderer.record(commands, plan, offscreen.target()); });
}

Image8 drawn(const Renderer& renderer, const FramePlan& plan) {
  return drawn(renderer, plan, VK_FORMAT_R8G8B8A8_UNORM, &Offscreen::render);
}
ImageF drawn(const Renderer& renderer, const FramePlan& plan, TargetFormat format) {
  return drawn(renderer, plan, format, &Offscreen::renderFloat);
}

void compareFormats(const Stage& stage, const FramePlan& plan, double levels) {
  const Renderer renderer(testDevice(), stage.gpuScene(), optionsOf(plan));
  const Image8 image = drawn(renderer, plan);
  CHECK(std::set(image.values.begin(), image.values.end()).size() > 40);
  for (const TargetFormat& format : kWideFormats) {
    CAPTURE(format.format, int(format.encoding));
    const ImageF seen = drawn(renderer, plan, format);
    CHECK(wrongChannels(seen, image, format, levels) == 0);
    const Encoding other = format.encoding == Encoding::linear ? Encoding::display : Encoding::linear;
    CHECK(wrongChannels(seen, image, {format.format, other}, levels) > image.values.size() / 10);
  }
}

// Colours of a picture that shows the background alone.
std::array<double, 4> plainColour(const ImageF& picture) {
  std::array<double, 4> colour;
  std::copy_n(picture.values.begin(), 4, colour.begin());
  for (std::size_t i = 0; i < picture.values.size(); ++i) REQUIRE(picture.values[i] == picture.values[i % 4]);
  return colour;
}

void checkColour(const std::array<double, 4>& seen, const std::array<double, 4>& expected, TargetFormat format) {
  CAPTURE(format.format, int(format.encoding));
  for (std::size_t c = 0; c < 4; ++c)
    CHECK(seen[c] == Approx(expected[c]).margin(roundingOf(expected[c], format.format, c < 3 ? 1023 : 3) + 1e-5));
}

}  // namespace

TEST_CASE("wide formats store exactly the 8-bit levels that are drawn") {
  const Stage stage(testDevice(), shownScene());
  SECTION("blended cells, holes and tiers") {
    compareFormats(stage, stage.plan(view(), settings()), 0);
  }
  SECTION("dithered cells") {
    RenderSettings dithered = settings();
    dithered.blend = BlendMode::dither;
    compareFormats(stage, stage.plan(view(), dithered), 0);
  }
  SECTION("the paper's order and colour mapping") {
    RenderSettings paper = settings();
    paper.order = DrawOrder::paper;
    paper.colourMapping = ColourMapping::paper;
    compareFormats(stage, stage.plan(view(), paper), 0);
  }
  SECTION("an overlay") {
    RenderSettings wireframe = settings();
    wireframe.overlay = Overlay::wireframe;
    compareFormats(stage, stage.plan(view(), wireframe), 0);
  }
}

TEST_CASE("wide formats store values between 8-bit levels within the rounding of 8 bits") {
  const Stage stage(testDevice(), shownScene());
  SECTION("filled holes") {
    RenderSettings filled = settings();
    filled.maxTier = kTierFilled;
    compareFormats(stage, stage.plan(view(), filled), kRoundedSteps);
  }
  SECTION("another render scale and a floor") {
    RenderSettings scaled = settings();
    scaled.renderScale = 0.7;
    scaled.floor = Floor{.height = -1};
    compareFormats(stage, stage.plan(view(), scaled), kRoundedSteps);
  }
  SECTION("a cross-fade of two draw orders") {
    FramePlan plan = stage.plan(view(), settings());
    REQUIRE(plan.cells.size() == 2);
    plan.previous = {plan.cells[1], plan.cells[0]};
    plan.previousWeight = 0.4;
    compareFormats(stage, plan, kRoundedSteps);
    // Finer values than those of 8 bits are kept.
    const Renderer renderer(testDevice(), stage.gpuScene(), optionsOf(plan));
    const ImageF half = drawn(renderer, plan, kHalf);
    const auto isBetween = [](float value) { return std::abs(value * 255 - std::round(value * 255)) > 0.2; };
    CHECK(std::ranges::count_if(half.values, isBetween) > 100);
  }
}

TEST_CASE("two views of a plan may have targets of different formats and encodings", "[multiview]") {
  const Stage stage(testDevice(), shownScene());
  std::vector<Camera> eyes{view(), view()};
  eyes[1].pose.position.x += 0.064;
  RenderSettings shown = settings();
  shown.switchSeconds = 0;
  const FramePlan plan = planFrame(stage.scene(), sceneBounds(stage.scene()), {eyes, shown});
  RendererOptions options = optionsOf(plan);
  for (auto& hidden : options.hiddenArea) hidden = {{-1, -1}, {-0.2, -1}, {-1, 0}};
  const Renderer renderer(testDevice(), stage.gpuScene(), options);
  Offscreen left(testDevice(), kExtent), right(testDevice(), kExtent);
  const std::array targets{left.target(), right.target()};
  const Image8 leftImage = left.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, targets); });
  const Image8 rightImage = right.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, targets); });
  CHECK(leftImage != rightImage);
  for (const auto& [first, second] : {std::pair(kLinearHalf, kTenBits), std::pair(kLinearTenBits, kHalf)}) {
    Offscreen leftWide(testDevice(), kExtent, first), rightWide(testDevice(), kExtent, second);
    const std::array wide{leftWide.target(), rightWide.target()};
    const auto record = [&](VkCommandBuffer commands) { renderer.record(commands, plan, wide); };
    CHECK(wrongChannels(leftWide.renderFloat(record), leftImage, first, 0) == 0);
    CHECK(wrongChannels(rightWide.renderFloat(record), rightImage, second, 0) == 0);
  }
}

TEST_CASE("backgrounds from black to white are stored in each encoding, and beyond them in half floats") {
  const Stage stage(testDevice(), shownScene());
  FramePlan plan = stage.plan(view(3.0), settings());  // shows nothing of the scene
  const Renderer renderer(testDevice(), stage.gpuScene(), optionsOf(plan));
  for (const glm::vec3 background : {glm::vec3(0), glm::vec3(1), glm::vec3(2, -0.5, 0.04), glm::vec3(0.2, 0.5, 0.9)})
    for (const AlphaContent alpha : {AlphaContent::opaque, AlphaContent::tier})
      for (const TargetFormat& format : kWideFormats) {
        plan.settings.background = background;
        plan.settings.alpha = alpha;
        std::array<double, 4> expected{0, 0, 0, alpha == AlphaContent::opaque ? 1.0 : 0.0};
        for (int c = 0; c < 3; ++c) {
          const double clamped = std::clamp(double(background[c]), 0.0, 1.0);
          const bool isHalf = format.format == VK_FORMAT_R16G16B16A16_SFLOAT;
          expected[std::size_t(c)] = stored(isHalf ? background[c] : clamped, format.encoding);
        }
        checkColour(plainColour(drawn(renderer, plan, format)), expected, format);
      }
}

TEST_CASE("two bits of alpha tell drawn pixels, filled pixels and holes apart") {
  const Stage stage(testDevice(), shownScene());
  RenderSettings filled = settings();
  filled.maxTier = kTierFilled;
  const FramePlan plan = stage.plan(view(0.5), filled);
  const Renderer renderer(testDevice(), stage.gpuScene(), optionsOf(plan));
  const Image8 image = drawn(renderer, plan);
  const ImageF seen = drawn(renderer, plan, kTenBits);
  std::size_t drawnCount = 0, filledCount = 0;
  for (std::size_t i = 3; i < image.values.size(); i += 4) {
    const int tier = image.values[i];
    REQUIRE((tier == 255 || tier == 63));
    drawnCount += tier == 255;
    filledCount += tier == 63;
    CHECK(seen.values[i] == Approx(tier == 255 ? 1.0 : 1.0 / 3));
  }
  CHECK(drawnCount > 100);
  CHECK(filledCount > 100);
  CHECK(plainColour(drawn(renderer, stage.plan(view(3.0), filled), kTenBits))[3] == 0);
}

TEST_CASE("combinations of formats and encodings that targets cannot have are refused with a reason") {
  const Stage stage(testDevice(), shownScene());
  for (const VkFormat format :
       {VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_B8G8R8A8_UNORM, VK_FORMAT_R8G8B8A8_SRGB, VK_FORMAT_B8G8R8A8_SRGB})
    CHECK(Renderer::supports(format));
  for (const TargetFormat& format : kWideFormats) CHECK(Renderer::supports(format));
  struct Refused {
    TargetFormat format;
    const char* reason;
  };
  for (const Refused& refused :
       {Refused{{VK_FORMAT_R8G8B8A8_UNORM, Encoding::linear}, "too coarse"},
        Refused{{VK_FORMAT_B8G8R8A8_UNORM, Encoding::linear}, "too coarse"},
        Refused{{VK_FORMAT_R8G8B8A8_SRGB, Encoding::linear}, "display-encoded"},
        Refused{{VK_FORMAT_B8G8R8A8_SRGB, Encoding::linear}, "display-encoded"},
        Refused{VK_FORMAT_A2R10G10B10_UNORM_PACK32, "A2B10G10R10"}, Refused{VK_FORMAT_R32G32B32A32_SFLOAT, "RGBA16F"},
        Refused{VK_FORMAT_UNDEFINED, "RGBA16F"}}) {
    CAPTURE(refused.format.format);
    std::string why;
    CHECK_FALSE(Renderer::supports(refused.format));
    CHECK_FALSE(Renderer::supports(refused.format, &why));
    CHECK_THAT(why, Catch::Contains(refused.reason));
    RendererOptions options = optionsFor({}, kExtent, refused.format);
    const Error error = errorOf([&] { Renderer(testDevice(), stage.gpuScene(), options); });
    CHECK(error.code() == ErrorCode::unsupported);
    CHECK_THAT(error.what(), Catch::Contains(refused.reason));
  }
}

TEST_CASE("a target that the options do not declare is cleared to the background in its encoding") {
  const Stage stage(testDevice(), shownScene());
  const FramePlan plan = stage.plan(view(), settings());
  const glm::vec3& background = plan.settings.background;
  for (const TargetFormat& declared : kWideFormats) {
    const Renderer renderer(testDevice(), stage.gpuScene(), optionsFor(plan.settings, kExtent, declared));
    for (const TargetFormat& format : kWideFormats) {
      Offscreen offscreen(testDevice(), kExtent, format);
      std::string why = "unchanged";
      CHECK(renderer.supports(offscreen.target(), &why) == (format == declared));
      CHECK(why == (format == declared ? "unchanged" : "RendererOptions::formats"));
      if (format == declared) continue;
      std::array<double, 4> expected{0, 0, 0, 1};
      for (int c = 0; c < 3; ++c) expected[std::size_t(c)] = stored(background[c], format.encoding);
      checkColour(plainColour(drawn(renderer, plan, format)), expected, format);
    }
    Target deep = Offscreen(testDevice(), kExtent, declared).target();
    deep.depth.emplace();
    std::string why;
    CHECK_FALSE(renderer.supports(deep, &why));
    CHECK(why == "RendererOptions::depth");
  }
}

TEST_CASE("each combination of format and encoding costs a pipeline of the composition") {
  const Stage stage(testDevice(), shownScene());
  RenderSettings shown = settings();
  shown.switchSeconds = 0;
  const FramePlan plan = stage.plan(view(), shown);
  RendererOptions options = optionsFor(shown, kExtent, kHalf);
  const auto pipelines = [&] { return Renderer(testDevice(), stage.gpuScene(), options).count(plan).pipelines; };
  const std::uint32_t one = pipelines();
  options.formats.push_back(kLinearHalf);
  CHECK(pipelines() == one + 1);
  options.formats.push_back(kLinearTenBits);
  CHECK(pipelines() == one + 2);
}
