// SPDX-License-Identifier: Apache-2.0
// Vote and gather on a device: comparison with the reference implementation (promise P9), and other relations.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <random>

#include "base/vulkan/gpu_image.h"
#include "base/vulkan/submit.h"
#include "gpu/transfer/readback.h"
#include "ibr/metrics.h"
#include "image/half_float.h"
#include "reference/gather_device.h"
#include "render/resident/depth_textures.h"
#include "render/resident/gpu_scene_state.h"
#include "shared/gather.h"
#include "support/error_of.h"
#include "support/gpu.h"

using namespace ibr;
using namespace ibr::test;

namespace {

// Maximum share of pixels at edges of the candidates' meshes that the device's sub-pixel grid assigns to another
// surface.
constexpr double kMaxSnapped = 0.002;
// Maximum share of other depths: hole depth is stored as half floats, and opacity ½ selects another surface.
constexpr double kMaxOtherDepth = 0.01;

const Camera kBeside = cameraAt({1.6, 0.2, 0.2}, 0.3, -0.03, 144, 108);  // a quarter radian away from the photographs
const Camera kBetween = cameraAt({0.22, 0.17, 0.06}, 0.02, -0.01, 144, 108);

// First channel of the buffers, as compareGathered expects the depth.
ImageF depthOf(const FrameBuffers& buffers) {
  ImageF depth(buffers.surface.width, buffers.surface.height, 1);
  for (std::size_t p = 0; p < depth.values.size(); ++p) depth.values[p] = buffers.surface.values[4 * p];
  return depth;
}

void checkAgainstReference(const GatherStage& stage, const OnDevice& device, const FramePlan& plan) {
  const std::vector<Image8> images = device.render(plan);
  for (std::size_t view = 0; view < plan.views.size(); ++view) {
    const reference::Composed ref = stage.compose(plan, view);
    const GatherComparison compared =
        compareGathered(ref, images[view], view == 0 ? depthOf(device.buffers(plan)) : ImageF());
    INFO("differing " << compared.differing << ", excused " << compared.excused << ", depth " << compared.wrongDepth);
    CHECK(compared.differing <= kMaxSnapped);
    CHECK(compared.wrongDepth <= kMaxOtherDepth);
    CHECK(compared.isExcusable());
  }
}

const GatherStage& wall() {
  static const GatherStage stage = gatherStage(wallOptions());
  return stage;
}
// The wall with one cell of its photographs.
const GatherStage& wallWithCell() {
  static const GatherStage stage = [] {
    GatherStage made = wall();
    addCell(made, wallOptions());
    return made;
  }();
  return stage;
}
const GatherStage& room() {
  static const GatherStage stage = gatherStage(roomOptions());
  return stage;
}

// Largest difference of red, green and blue, 8-bit levels.
double largestDifference(const Image8& a, const Image8& b) {
  double largest = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x)
      for (std::size_t c = 0; c < 3; ++c)
        largest = std::max(largest, std::abs(double(a.pixel(x, y)[c]) - double(b.pixel(x, y)[c])));
  return largest;
}

}  // namespace

TEST_CASE("gather pass: a device agrees with the reference implementation", "[P9]") {
  const OnDevice device(wall());
  SECTION("with default settings") {
    checkAgainstReference(wall(), device, wall().plan(kBetween));
  }
  SECTION("from beside, behind and in front of the photographs") {
    for (const Camera& view : {cameraAt({-0.3, 0.1, 0.2}, -0.1, 0, 120, 96), cameraAt({0.2, 0.2, 0.8}, 0, 0, 120, 96),
                               cameraAt({0.3, 0, -1}, 0.1, 0, 120, 96, 1.4)})
      checkAgainstReference(wall(), device, wall().plan(view));
  }
  SECTION("with other gatherColours, gatherLayers and voteScale") {
    for (const std::uint32_t colours : {1u, 2u, 8u})
      for (const std::uint32_t layers : {1u, 2u})
        for (const double scale : {0.3, 1.0}) {
          RenderSettings settings = GatherStage::gatherSettings();
          settings.gatherColours = colours;
          settings.gatherLayers = layers;
          settings.voteScale = scale;
          checkAgainstReference(wall(), device, wall().plan(std::vector{kBetween}, settings));
        }
  }
  SECTION("with photographs of small weight") {
    FramePlan plan = wall().plan(kBetween);
    plan.photographs[0].weight = 0.2;
    plan.photographs[2].weight = 0;
    checkAgainstReference(wall(), device, plan);
  }
  SECTION("for two eyes") {
    checkAgainstReference(
        wall(), device,
        wall().plan({cameraAt({0.2, 0.1, 0}, 0, 0, 120, 96), cameraAt({0.264, 0.1, 0}, 0, 0, 96, 120)}));
  }
}

TEST_CASE("gather pass: uncertain, disagreeing hypotheses agree with the reference implementation", "[P9]") {
  // Depths wave about the wall, inside the tolerance of about 0.05 and beyond. No vertex is opaque.
  for (const double wave : {0.03, 0.08}) {
    GatherOptions options = wallOptions();
    options.inverseDepth = [wave](std::size_t node, glm::dvec2 pixel, double rho) {
      return rho + wave * (1 + std::sin(pixel.x / 40 + 2.1 * double(node)));
    };
    options.evidence = [](std::size_t node, glm::dvec2 pixel) {
      return Evidence{std::uint8_t(node % 4), float(0.4 + 0.2 * std::sin(pixel.y / 30 + double(node)))};
    };
    const GatherStage stage = gatherStage(options);
    const OnDevice device(stage);
    for (const std::uint32_t layers : {1u, 2u}) {
      RenderSettings settings = GatherStage::gatherSettings();
      settings.gatherLayers = layers;
      checkAgainstReference(stage, device, stage.plan(std::vector{kBetween}, settings));
    }
    // A few thousandths of a radian from a photograph, its border and its occlusions begin to count.
    checkAgainstReference(stage, device, stage.plan(cameraAt({0.012, 0.008, 0}, 0, 0, 160, 120)));
    FramePlan far = stage.plan(kBetween);
    far.photographs[1].distance = 40;  // the distance of a photograph at 0.08 radians
    checkAgainstReference(stage, device, far);
  }
}

TEST_CASE("gather pass: mip levels of photographs for uncertain surfaces agree with the reference", "[P9]") {
  for (const float consensus : {0.0f, 0.1f, 0.3f}) {
    GatherOptions options = wallOptions();
    options.evidence = [&](std::size_t node, glm::dvec2 pixel) {
      return pixel.x < 100 ? Evidence{0, consensus} : Evidence{std::uint8_t(node), 0.5f * consensus};
    };
    const GatherStage stage = gatherStage(options);
    checkAgainstReference(stage, OnDevice(stage), stage.plan(kBeside));
  }
}

// Inverts a photograph, so that its weight becomes visible in the image.
void invert(GatherStage& stage, std::size_t node) {
  Image8 negative = stage.made.photographs[node];
  for (std::uint8_t& level : negative.values) level = std::uint8_t(255 - level);
  stage.setPhotograph(node, std::move(negative));
}

TEST_CASE("gather pass: certainty and occlusion of two surfaces agree with the reference implementation", "[P9]") {
  // One photograph with other colours has its own surface in front of or behind the surface of the others.
  const auto check = [](const Camera& view, double off, float consensus) {
    CAPTURE(view.pose.position.x, off, consensus);
    GatherOptions options = wallOptions();
    for (TexturedPlane& plane : options.planes) plane.wavelength = 0.15;  // shows which mip level is read
    options.inverseDepth = [off](std::size_t node, glm::dvec2, double rho) { return node == 0 ? rho + off : rho; };
    options.evidence = [consensus](std::size_t node, glm::dvec2) {
      return node == 0 ? Evidence{0, consensus} : Evidence{1, 0.6f};
    };
    GatherStage stage = gatherStage(options);
    invert(stage, 0);
    checkAgainstReference(stage, OnDevice(stage), stage.plan(view));
  };
  for (const float consensus : {0.0f, 0.6f}) {
    for (const double off : {-0.1, 0.1, 0.2})  // at 0.2 the surface hides the others unless its uncertainty is large
      for (const Camera& view : {kBeside, kBetween}) check(view, off, consensus);
    check(cameraAt({0.012, 0.008, 0}, 0, 0, 160, 120), 0.1, consensus);  // where the own surface begins to hide others
  }
}

TEST_CASE("gather pass: shares of the photographs that show a pixel sum to 1") {
  const FrameBuffers buffers = OnDevice(wall()).buffers(wall().plan(kBetween));
  std::size_t shared = 0;
  for (std::size_t p = 0; p < buffers.weights.values.size(); p += 4) {
    if (std::isinf(buffers.confidence.values[p / 2 + 1])) continue;  // nothing is drawn here
    const float* share = &buffers.weights.values[p];
    REQUIRE(share[0] + share[1] + share[2] + share[3] == Approx(1).margin(2e-3));
    REQUIRE(share[0] >= share[1]);
    shared += share[1] > 0.05f;
  }
  CHECK(shared > 1000);
}

TEST_CASE("gather pass: a vote's code preserves its components") {
  CHECK(shader::gatherIsHole(0));
  for (const bool first : {false, true})
    for (const bool second : {false, true})
      for (const float consensus : {0.0f, 0.1f, 0.499f, 1.0f})
        for (const float other : {0.0f, 0.5f, 1.0f}) {
          const float coded = shader::gatherCode(first, consensus, second, other, 1.0f);
          const auto code = std::uint32_t(coded);
          CHECK(float(code) == coded);
          CHECK(shader::gatherSpread(code) == 1.0f);
          CHECK_FALSE(shader::gatherIsHole(code));
          CHECK(shader::gatherIsCompleted(code, 0) == first);
          CHECK(shader::gatherIsCompleted(code, 1) == second);
          CHECK(shader::gatherConsensus(code, 0) == Approx(consensus).margin(0.51 / 255));
          CHECK(shader::gatherConsensus(code, 1) == Approx(other).margin(0.51 / 255));
        }
}

TEST_CASE("gather pass: a vote's code preserves spreads above a thousandth to an eighth") {
  const auto kept = [](float spread) {
    return shader::gatherSpread(std::uint32_t(shader::gatherCode(true, 1.0f, true, 1.0f, spread)));
  };
  CHECK(kept(0.0f) == 0.0f);
  CHECK(kept(1e-4f) == 0.0f);
  CHECK(kept(1.0f) == 1.0f);
  for (float spread = 0.001f; spread < 1; spread *= 1.01f) CHECK(kept(spread) == Approx(spread).epsilon(0.125));
}

TEST_CASE("gather pass: the deviation of depth grows with step, spread and colour variance") {
  const float rho = 0.1f, step = 0.02f;
  const auto of = [&](float spread, float variance) { return shader::gatherSigma(0, rho, step, spread, variance); };
  CHECK(of(0, 0) == Approx(0.18f * step));
  CHECK(of(0, 1e6f) == of(0, 0));  // no other photograph disagrees
  CHECK(of(0.5f, 0) == Approx(std::hypot(0.18f * step, 0.85f * 0.5f * rho)));
  CHECK(of(0.5f, 225) == Approx(std::hypot(0.18f * step, 5 * 0.85f * 0.5f * rho)));
  CHECK(of(0.5f, 1e9f) == of(0.5f, 900));
  CHECK(shader::gatherSigma(0, 0, step, 1, 1e9f) == Approx(0.18f * step));  // infinitely far surface
  for (const int tier : {2, 3}) CHECK(shader::gatherSigma(tier, rho, step, 0, 0) == rho);
}

TEST_CASE("gather pass: deviations agree with the reference implementation", "[P9]") {
  GatherOptions options = wallOptions();
  options.inverseDepth = [](std::size_t node, glm::dvec2 pixel, double rho) {
    return rho * (1 + 0.2 * std::sin(pixel.x / 40 + 2.1 * double(node)));
  };
  options.evidence = [](std::size_t node, glm::dvec2 pixel) {
    return Evidence{std::uint8_t(pixel.y < 40 ? 0 : 1 + node), 0.6f};
  };
  const GatherStage stage = gatherStage(options);
  const FramePlan plan = stage.plan(kBetween);
  const FrameBuffers buffers = OnDevice(stage).buffers(plan);
  const reference::Composed ref = stage.compose(plan);
  std::size_t compared = 0, wrong = 0, completed = 0;
  double least = 1e9, most = 0;
  for (int y = 0; y < buffers.surface.height; ++y)
    for (int x = 0; x < buffers.surface.width; ++x) {
      const int tier = int(buffers.surface.pixel(x, y)[1]);
      if (tier < 0 || int(255 - 64 * tier) != int(ref.picture.pixel(x, y)[3])) continue;
      if (double(ref.supportMargin.pixel(x, y)[0]) < 1e-3) continue;
      const double deviation = double(buffers.confidence.pixel(x, y)[1]), truth = double(ref.deviation.pixel(x, y)[0]);
      ++compared;
      wrong += !(std::abs(deviation - truth) <= 0.13 * truth);
      completed += tier != 0;
      if (tier != 0) continue;
      least = std::min(least, deviation);
      most = std::max(most, deviation);
    }
  CHECK(compared > 10000);
  CHECK(completed > 500);
  CHECK(double(wrong) <= 0.01 * double(compared));
  CHECK(most > 5 * least);
}

TEST_CASE("gather pass: panoramas agree with the reference implementation", "[P9]") {
  const OnDevice device(room());
  for (const double yaw : {0.0, 1.5, 3.1})
    checkAgainstReference(room(), device, room().plan(cameraAt({0.2, 0.1, 0.1}, yaw, 0.3, 120, 96)));
  // Inverted colours show the photograph's weight. Its depth is too near: the surface is partly hidden.
  GatherOptions options = roomOptions();
  options.inverseDepth = [](std::size_t node, glm::dvec2, double rho) { return node == 0 ? 1.12 * rho : rho; };
  GatherStage stage = gatherStage(options);
  invert(stage, 0);
  FramePlan plan = stage.plan(cameraAt({0.2, 0.1, 0.1}, 0, 0.1, 120, 96, 1.4));
  plan.gather.spacing = 8;  // spacing so small that depths are distinguished
  checkAgainstReference(stage, OnDevice(stage), plan);
}

TEST_CASE("gather pass: bicubic filtering of magnified photographs agrees with the reference", "[P9]") {
  for (const GatherOptions& options : {wallOptions(), roomOptions()}) {
    GatherStage stage = gatherStage(options);
    std::mt19937 random(5);
    for (std::size_t node = 0; node < stage.made.photographs.size(); ++node) {  // fine detail distinguishes filters
      Image8 noisy = stage.made.photographs[node];
      for (std::uint8_t& level : noisy.values) level = std::uint8_t(random() % 256);
      stage.setPhotograph(node, std::move(noisy));
    }
    const Camera near = cameraAt({0.2, 0.1, -0.4}, 0, 0.05, 160, 120, 0.4);
    const Image8 trilinear = OnDevice(stage).image(stage.plan(near));
    stage.filter = TextureFilter::bicubic;
    const OnDevice device(stage);
    checkAgainstReference(stage, device, stage.plan(near));
    CHECK(largestDifference(device.image(stage.plan(near)), trilinear) > 3);
    for (const int width : {100, 140})  // between two mip levels
      checkAgainstReference(stage, device, stage.plan(cameraAt({0.2, 0.1, 0}, 0, 0.05, width, width)));
  }
}

TEST_CASE("gather pass: gains and masks agree with the reference implementation", "[P9]") {
  GatherStage stage = gatherStage(wallOptions());
  stage.made.scene.nodes[0].gain = {1.4, 1.0, 0.7};
  stage.made.scene.nodes[1].gain = {0.6, 0.8, 1.3};
  Image8 masked(stage.made.photographs[1].width, stage.made.photographs[1].height, 4, 255);
  for (int y = 0; y < masked.height; ++y)
    for (int x = 0; x < masked.width; ++x) {
      std::ranges::copy(stage.made.photographs[1].pixel(x, y).first(3), masked.pixel(x, y).begin());
      if (x > 60 && x < 140 && y > 40) masked.pixel(x, y)[3] = 0;
    }
  stage.setPhotograph(1, std::move(masked));
  const OnDevice device(stage);
  FramePlan plan = stage.plan(kBetween);
  plan.exposure = {1.1, 1.2, 0.9};
  checkAgainstReference(stage, device, plan);
}

TEST_CASE("gather pass: at a photograph's pose the image equals the photograph, border included") {
  GatherOptions uncertain = wallOptions();
  uncertain.evidence = [](std::size_t, glm::dvec2) { return Evidence{0, 0.1f}; };
  for (const GatherStage& stage : {wall(), gatherStage(uncertain)}) {
    const OnDevice device(stage);
    for (std::size_t n = 0; n < stage.made.scene.nodes.size(); ++n) {
      const Image8 image = device.image(stage.plan(stage.made.scene.nodes[n].camera));
      CHECK(psnr(image, stage.made.photographs[n]) > 45);
      CHECK(largestDifference(image, stage.made.photographs[n]) <= 2);
    }
  }
}

TEST_CASE("gather pass: a compressed photograph is shown within 1 dB of its codec's quality") {
  if (!testDevice().supportsBlockCompression()) return;
  for (const TextureFormat format : {TextureFormat::bc7, TextureFormat::bc1}) {
    CAPTURE(textureFormatName(format));
    const OnDevice device(wall(), 0, format);
    for (std::size_t n = 0; n < wall().made.scene.nodes.size(); ++n) {
      const Image8 coded = decodeTexture(encodeTexture(wall().textures[n], format)).front();
      const Image8 image = device.image(wall().plan(wall().made.scene.nodes[n].camera));
      const double left = psnr(coded, wall().made.photographs[n]);
      CHECK(left < 50);  // the codec's error is measurable
      CHECK(psnr(image, wall().made.photographs[n]) >= left - 1);
    }
  }
}

TEST_CASE("gather pass: two views at once equal two single views") {
  const OnDevice device(wall());
  const FramePlan both =
      wall().plan({cameraAt({0.2, 0.1, 0}, 0, 0, 120, 96), cameraAt({0.264, 0.1, 0}, 0, 0, 120, 96)});
  const std::vector<Image8> together = device.render(both);
  for (std::size_t view = 0; view < 2; ++view) {
    FramePlan one = both;  // same distances as the plan of both views
    one.views = {both.views[view]};
    CHECK(device.image(one) == together[view]);
  }
  RendererOptions single = optionsFor(both.settings, {1, 1});
  single.fill = false;
  single.multiview = false;
  CHECK(device.render(both, device.renderer(both, single)) == together);
}

TEST_CASE("gather pass: the order of the photographs does not change the image") {
  const OnDevice device(wall());
  FramePlan plan = wall().plan(kBetween);
  const Image8 image = device.image(plan);
  std::ranges::rotate(plan.photographs, plan.photographs.begin() + 1);
  CHECK(largestDifference(image, device.image(plan)) <= 1);
}

TEST_CASE("gather pass: a frame recorded again is the same after other frames") {
  const OnDevice device(wall());
  const FramePlan plan = wall().plan(kBetween), other = wall().plan(cameraAt({0.4, 0, 0.3}, 0.3, 0, 100, 100));
  RendererOptions wanted = optionsFor(plan.settings, {160, 120});
  const Renderer renderer = device.renderer(plan, wanted);
  const std::vector<Image8> first = device.render(plan, renderer);
  device.render(other, renderer);
  CHECK(device.render(plan, renderer) == first);
}

TEST_CASE("gather pass: with a budget the image is the same once its photographs are loaded") {
  const OnDevice whole(wall());
  const FramePlan plan = wall().plan(kBetween);
  const std::uint64_t all = whole.memory().sum();
  OnDevice streamed(wall(), all - 1);
  REQUIRE(streamed.gpuScene().needsStreaming());
  std::uint64_t frame = 0;
  GpuScene::StreamStatus state;
  do {
    ++frame;
    submitAndWait(testDevice(), [&](VkCommandBuffer commands) {
      state = streamed.gpuScene().stream(commands, plan, frame, frame - 1);
    });
  } while (state.waiting > 0 && frame < 100);
  CHECK(state.needed >= 3 + 3);  // photographs and depth textures
  CHECK(streamed.gpuScene().memory().sum() < all);
  const Image8 image = streamed.image(plan);
  if (state.overBudget == 0) CHECK(image == whole.image(plan));
  CHECK(psnr(image, whole.image(plan)) > 25);
}

TEST_CASE("gather pass: with streamed depth textures and meshes the image is the same once they are loaded") {
  GatherOptions options = wallOptions();
  const std::vector<Camera> cameras = options.cameras;
  for (int i = 1; i < 4; ++i)
    for (Camera camera : cameras) {
      camera.pose.position.x += 0.05 * i;
      options.cameras.push_back(camera);
    }
  options.gridStep = 4;
  const GatherStage stage = gatherStage(options);
  const OnDevice whole(stage);
  const std::uint64_t budget = whole.memory().sum() * 3 / 5;
  OnDevice streamed(stage, budget);
  const GpuScene::State& state = stateOf(streamed.gpuScene());
  REQUIRE(state.meshes.streams());
  REQUIRE(state.textures->streams());
  CHECK(state.streamer->isStreamed(state.loader.items().depth(0)));
  std::uint64_t frame = 0;
  for (const std::uint32_t first : {0u, 9u, 3u}) {  // groups of three photographs
    FramePlan plan = stage.plan(kBetween);
    plan.photographs = {plan.photographs.begin() + first, plan.photographs.begin() + first + 3};
    GpuScene::StreamStatus status;
    do {
      ++frame;
      submitAndWait(testDevice(), [&](VkCommandBuffer commands) {
        status = streamed.gpuScene().stream(commands, plan, frame, frame - 1);
      });
      CHECK(streamed.gpuScene().memory().sum() <= budget);
    } while (status.waiting > 0);
    CHECK(status.needed == 9);  // photographs, depth textures, meshes
    CHECK(status.overBudget == 0);
    for (const PlannedPhotograph& photograph : plan.photographs)
      CHECK_FALSE(state.backdrops[photograph.backdrop].place.isStandIn);
    CHECK(streamed.image(plan) == whole.image(plan));
  }
}

TEST_CASE("gather pass: a reduced depth texture has the largest inverse distance of each block") {
  Texture depth;
  depth.format = TextureFormat::rg16f;
  depth.width = 5;
  depth.height = 3;
  std::vector<std::byte>& bytes = depth.levels.emplace_back(5 * 3 * 4);
  const auto put = [&](int x, int y, float rho, float consensus) {
    const std::array<std::uint16_t, 2> texel{toHalf(rho), toHalf(consensus)};
    std::memcpy(&bytes[std::size_t(y * 5 + x) * 4], texel.data(), 4);
  };
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 5; ++x) put(x, y, 0.01f * float(1 + x + 5 * y), 0.5f);
  put(1, 0, 0.75f, 0.25f);
  const Texture half = reducedDepth(depth, 1), one = reducedDepth(depth, 5);
  const auto texelOf = [](const Texture& of, std::size_t index) {
    std::array<std::uint16_t, 2> texel;
    std::memcpy(texel.data(), &of.levels[0][index * 4], 4);
    return texel;
  };
  REQUIRE((half.width == 2 && half.height == 1));
  CHECK(texelOf(half, 0) == std::array{toHalf(0.75f), toHalf(0.25f)});
  CHECK(texelOf(half, 1) == std::array{toHalf(0.15f), toHalf(0.5f)});
  REQUIRE((one.width == 1 && one.height == 1));
  CHECK(texelOf(one, 0) == std::array{toHalf(0.75f), toHalf(0.25f)});
}

TEST_CASE("gather pass: memory of the gather is counted only with a gather") {
  const OnDevice device(wall());
  const FramePlan plan = wall().plan(kBetween);
  const Renderer gathers = device.renderer(plan);
  const Renderer::Counters counted = gathers.count(plan);
  CHECK(counted.bytes.gather > 0);
  CHECK(counted.dispatches > 1);
  CHECK(counted.draws >= 3 + 1 + 1);
  FramePlan cells = plan;
  cells.settings.composition = Composition::cells;
  cells.photographs.clear();
  CHECK(device.renderer(cells).count(cells).bytes.gather == 0);
}

TEST_CASE("gather pass: tiers beyond maxTier are not drawn") {
  GatherOptions options = wallOptions();
  options.evidence = [](std::size_t, glm::dvec2 pixel) { return pixel.x < 60 ? Evidence{0, 0.1f} : Evidence{}; };
  const GatherStage stage = gatherStage(options);
  const OnDevice device(stage);
  RenderSettings settings = GatherStage::gatherSettings();
  const Image8 all = device.image(stage.plan(std::vector{kBetween}, settings));
  settings.maxTier = kTierConsistent;
  const Image8 agreed = device.image(stage.plan(std::vector{kBetween}, settings));
  std::size_t left = 0;
  for (std::size_t p = 0; p < all.values.size(); p += 4) {
    const bool confirmed = all.values[p + 3] == 255;
    left += !confirmed;
    if (agreed.values[p + 3] != (confirmed ? 255 : 0)) FAIL("pixel " << p / 4);
  }
  CHECK(left > 100);
}

TEST_CASE("gather pass: depth of a target is that of the nearest opaque surface") {
  const OnDevice device(wall());
  FramePlan plan = wall().plan(kBetween);
  plan.nearDistance = 0.5;
  const VkExtent2D extent = extentOf(kBetween);
  RendererOptions wanted = optionsFor(plan.settings, extent);
  wanted.fill = false;
  wanted.depth = true;
  wanted.overlays = {Overlay::tiers};
  const Renderer renderer = device.renderer(plan, wanted);
  Offscreen offscreen(testDevice(), extent);
  const GpuImage image(testDevice(),
                       {.format = VK_FORMAT_D32_SFLOAT,
                        .extent = extent,
                        .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
                        .aspect = VK_IMAGE_ASPECT_DEPTH_BIT},
                       "caller's depth");
  Target target = offscreen.target();
  target.depth = DepthTarget{.image = image.get(), .view = image.view(), .nearPlane = 0.5};
  const auto depthOfTarget = [&] {
    return readImage(testDevice(), image.get(), extent, 4, use::kDepthAttachment, VK_IMAGE_ASPECT_DEPTH_BIT);
  };
  const Image8 picture = offscreen.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, target); });
  CHECK(picture == device.image(plan));  // a depth target does not change colours
  const std::vector<std::byte> bytes = depthOfTarget();
  const reference::Composed ref = wall().compose(plan);
  std::size_t wrong = 0;
  for (std::size_t p = 0; p < ref.opaqueInverseDepth.values.size(); ++p) {
    float value;
    std::memcpy(&value, &bytes[4 * p], sizeof value);
    const double rho = (1 - double(value)) / 0.5;  // for an infinite far plane
    wrong += std::abs(rho - double(ref.opaqueInverseDepth.values[p])) > 1e-3;
  }
  CHECK(double(wrong) <= kMaxOtherDepth * double(ref.opaqueInverseDepth.values.size()));
  plan.settings.overlay = Overlay::tiers;
  CHECK(offscreen.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, target); }) != picture);
  CHECK(depthOfTarget() == bytes);
}

TEST_CASE("gather pass: the hidden area is not drawn, and other pixels are unchanged") {
  const OnDevice device(wall());
  const FramePlan plan = wall().plan(kBetween);
  RendererOptions wanted = optionsFor(plan.settings, {1, 1});
  wanted.fill = false;
  const Image8 all = device.render(plan, device.renderer(plan, wanted)).front();
  wanted.hiddenArea[0] = {{-9, -9}, {0, -9}, {-9, 9}, {0, -9}, {0, 9}, {-9, 9}};  // left half of the view
  const Image8 half = device.render(plan, device.renderer(plan, wanted)).front();
  const double middle = kBetween.intrinsics.cx;
  for (int y = 0; y < all.height; ++y)
    for (int x = 0; x < all.width; ++x) {
      if (x + 1 < middle) CHECK(half.pixel(x, y)[3] == 0);
      if (x > middle + 1) CHECK(std::ranges::equal(half.pixel(x, y), all.pixel(x, y)));
    }
}

TEST_CASE("gather pass: a camera step of a thousandth of the spacing changes each tile little") {
  const OnDevice device(wall());
  const double step = 0.0005;  // camera step relative to a spacing of half a unit
  const auto at = [&](int i) {
    FramePlan plan = wall().plan(cameraAt({0.1 + step * i, 0.15 + 0.3 * step * i, 0.03}, 0.02, 0, 160, 128));
    plan.nearDistance = 0.05;
    return plan;
  };
  const Renderer renderer = device.renderer(at(0));
  constexpr int kTile = 32;
  std::size_t tiles = 0, beyond = 0;
  double largest = 0;
  Image8 before = device.render(at(0), renderer).front();
  for (int i = 1; i <= 60; ++i) {
    Image8 now = device.render(at(i), renderer).front();
    for (int top = 0; top + kTile <= now.height; top += kTile)
      for (int left = 0; left + kTile <= now.width; left += kTile) {
        double sum = 0;
        for (int y = top; y < top + kTile; ++y)
          for (int x = left; x < left + kTile; ++x)
            for (std::size_t c = 0; c < 3; ++c)
              sum += std::abs(double(now.pixel(x, y)[c]) - double(before.pixel(x, y)[c]));
        const double mean = sum / (3.0 * kTile * kTile);
        ++tiles;
        beyond += mean > 2;
        largest = std::max(largest, mean);
      }
    before = std::move(now);
  }
  CHECK(double(beyond) <= 0.001 * double(tiles));
  CHECK(largest <= 8);
}

TEST_CASE("gather pass: a hybrid shows cells and gathers the other pixels") {
  const Scene& scene = wallWithCell().made.scene;
  const OnDevice device(wallWithCell());
  const SceneBounds bounds = sceneBounds(scene);
  RenderSettings settings = GatherStage::gatherSettings();
  const auto drawn = [&](Composition composition, int maxTier) {
    settings.composition = composition;
    settings.maxTier = maxTier;
    return device.image(planFrame(scene, bounds, {{kBetween}, settings}));
  };
  const Image8 agreed = drawn(Composition::cells, kTierConsistent),
               gathered = drawn(Composition::gathered, kTierFilled), hybrid = drawn(Composition::hybrid, kTierFilled);
  std::size_t cellPixels = 0, gatheredPixels = 0;
  for (std::size_t p = 0; p < hybrid.values.size(); p += 4) {
    const bool isCell = agreed.values[p + 3] == 255;
    (isCell ? cellPixels : gatheredPixels) += 1;
    const Image8& from = isCell ? agreed : gathered;
    if (!std::equal(&hybrid.values[p], &hybrid.values[p] + 3, &from.values[p])) FAIL("pixel " << p / 4);
  }
  CHECK(cellPixels > 1000);
  CHECK(gatheredPixels > 100);
}

TEST_CASE("gather pass: the overlap overlay draws cells, and other overlays are gathered") {
  const Scene& scene = wallWithCell().made.scene;
  const SceneBounds bounds = sceneBounds(scene);
  const OnDevice device(wallWithCell());
  RenderSettings settings = GatherStage::gatherSettings();
  for (const Composition composition : {Composition::gathered, Composition::hybrid}) {
    settings.composition = composition;
    for (const Overlay overlay : {Overlay::wireframe, Overlay::tiers, Overlay::weights, Overlay::confidence,
                                  Overlay::depth, Overlay::agreement}) {
      settings.overlay = overlay;
      const FramePlan plan = planFrame(scene, bounds, {{kBetween}, settings});
      CHECK(plan.settings.composition == composition);
      CHECK(!plan.photographs.empty());
    }
    settings.overlay = Overlay::overlap;
    const FramePlan shown = planFrame(scene, bounds, {{kBetween}, settings});
    CHECK(shown.settings.composition == Composition::cells);
    CHECK(shown.photographs.empty());
    settings.composition = Composition::cells;
    const Image8 picture = device.image(shown);
    CHECK(picture == device.image(planFrame(scene, bounds, {{kBetween}, settings})));
    std::size_t counted = 0;
    for (std::size_t p = 0; p < picture.values.size(); p += 4) counted += picture.values[p + 3] == 255;
    CHECK(counted > 1000);
  }
}

TEST_CASE("gather pass: a scene without evidence is drawn with its cells") {
  GatherStage stage = wallWithCell();
  for (Cell& backdrop : stage.made.scene.backdrops) {
    backdrop.mesh.confirmations.clear();
    backdrop.mesh.consensus.clear();
  }
  RenderSettings settings = GatherStage::gatherSettings();
  const FramePlan plan = planFrame(stage.made.scene, sceneBounds(stage.made.scene), {{kBetween}, settings});
  CHECK(plan.settings.composition == Composition::cells);
  CHECK(plan.photographs.empty());
  settings.composition = Composition::cells;
  const OnDevice device(stage);
  const FramePlan cells = planFrame(stage.made.scene, sceneBounds(stage.made.scene), {{kBetween}, settings});
  const Image8 picture = device.image(plan);
  CHECK(picture == device.image(cells));
  std::size_t drawn = 0;
  for (std::size_t p = 0; p < picture.values.size(); p += 4) drawn += picture.values[p + 3] == 255;
  CHECK(drawn > 1000);
}

TEST_CASE("gather pass: settings that the gather does not support are refused by name") {
  const Scene& scene = wall().made.scene;
  const SceneBounds bounds = sceneBounds(scene);
  const auto refused = [&](auto change, const char* field) {
    RenderSettings settings = GatherStage::gatherSettings();
    change(settings);
    CHECK_THAT(std::string(errorOf([&] {
                             planFrame(scene, bounds, {{kBetween}, settings});
                           }).what()),
               Catch::Contains(field));
  };
  refused([](RenderSettings& s) { s.gatherCandidates = 0; }, "gatherCandidates");
  refused([](RenderSettings& s) { s.gatherCandidates = kMaxGatherCandidates + 1; }, "gatherCandidates");
  refused([](RenderSettings& s) { s.gatherColours = 0; }, "gatherColours");
  refused([](RenderSettings& s) { s.gatherColours = kMaxGatherColours + 1; }, "gatherColours");
  refused([](RenderSettings& s) { s.gatherLayers = 3; }, "gatherLayers");
  refused([](RenderSettings& s) { s.voteScale = 0; }, "voteScale");
  refused([](RenderSettings& s) { s.voteScale = 1.5; }, "voteScale");
  refused([](RenderSettings& s) { s.order = DrawOrder::paper; }, "order");
  refused([](RenderSettings& s) { s.colourMapping = ColourMapping::paper; }, "colourMapping");
}
