// SPDX-License-Identifier: Apache-2.0
// DepthTarget, against which a caller tests polygons, compared with the generated scene's exact depth.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>

#include "base/vulkan/gpu_image.h"
#include "gpu/transfer/readback.h"
#include "reference/stage.h"
#include "support/gpu.h"

using namespace ibr;
using namespace ibr::test;

namespace {

// Renders one frame with a depth image. Returns the depth values that the caller's polygons are tested against.
std::vector<float> depthOf(const Stage& stage, const FramePlan& plan, DepthTarget convention) {
  const Camera& view = plan.views[0];
  const VkExtent2D extent{std::uint32_t(view.intrinsics.width), std::uint32_t(view.intrinsics.height)};
  const GpuScene gpuScene(testDevice(), stage.scene(), {.source = stage.source(), .filter = TextureFilter::trilinear});
  const Renderer renderer(
      testDevice(), gpuScene,
      {.maxExtent = extent, .depth = true, .overlays = {plan.settings.overlay}, .orders = {plan.settings.order}});
  Offscreen offscreen(testDevice(), extent);
  const GpuImage image(testDevice(),
                       {.format = VK_FORMAT_D32_SFLOAT,
                        .extent = extent,
                        .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
                        .aspect = VK_IMAGE_ASPECT_DEPTH_BIT},
                       "caller's depth");
  convention.image = image.get();
  convention.view = image.view();
  Target target = offscreen.target();
  target.depth = convention;
  const Image8 picture = offscreen.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, target); });
  CHECK(picture == stage.render(plan));  // depth changes no colour
  const std::vector<std::byte> bytes =
      readImage(testDevice(), image.get(), extent, 4, use::kDepthAttachment, VK_IMAGE_ASPECT_DEPTH_BIT);
  std::vector<float> values(bytes.size() / 4);
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

}  // namespace

TEST_CASE("depth equals the scene's in the caller's convention, and empty pixels are far") {
  SyntheticOptions options = place(4);
  options.cells = {{0, 1, 2}, {1, 2, 3}, {0, 3}};
  const Stage stage(testDevice(), makeScene(options));
  const Camera view = cameraAt({0.45, 0.3, 0.2}, 0.05);
  const FramePlan plan = stage.plan(view, withTiers());
  const Image8 picture = stage.render(plan);
  const ImageF truth = renderDepth(stage.place(), view);
  for (const DepthTarget& convention : {DepthTarget{.nearPlane = 0.1}, DepthTarget{.nearPlane = 0.1, .farPlane = 100},
                                        DepthTarget{.nearPlane = 0.5, .reversed = true},
                                        DepthTarget{.nearPlane = 0.5, .farPlane = 20, .reversed = true}}) {
    const std::vector<float> values = depthOf(stage, plan, convention);
    const double n = convention.nearPlane, f = convention.farPlane;
    std::size_t compared = 0, wrong = 0, notFar = 0;
    for (int y = 1; y + 1 < truth.height; ++y)
      for (int x = 1; x + 1 < truth.width; ++x) {
        double depth = values[std::size_t(y * truth.width + x)];
        if (convention.reversed) depth = 1 - depth;
        if (picture.pixel(x, y)[3] == 0) {
          notFar += depth != 1;
          continue;
        }
        // Skips the board's border, where a pixel's centre may lie on either side.
        const float here = truth.pixel(x, y)[0];
        if (std::abs(truth.pixel(x - 1, y)[0] - here) > 0.5 || std::abs(truth.pixel(x + 1, y)[0] - here) > 0.5 ||
            std::abs(truth.pixel(x, y - 1)[0] - here) > 0.5 || std::abs(truth.pixel(x, y + 1)[0] - here) > 0.5)
          continue;
        const double z = std::isinf(f) ? n / (1 - depth) : n * f / (f - depth * (f - n));
        ++compared;
        wrong += !(std::abs(z - here) <= 5e-3 * here);
      }
    CHECK(compared > values.size() / 4);
    // Around the board's outline on the wall, the cells' meshes differ from the true surface.
    CHECK(double(wrong) <= 0.01 * double(compared));
    CHECK(notFar == 0);
  }
}

TEST_CASE("a scene at infinity and the paper's draw order have far depth") {
  SyntheticOptions options = place(2);
  options.atInfinity = true;
  const Stage stage(testDevice(), makeScene(options));
  for (const DrawOrder order : {DrawOrder::ours, DrawOrder::paper}) {
    RenderSettings settings = withTiers();
    settings.order = order;
    for (const float value : depthOf(stage, stage.plan(cameraAt({0.4, 0, 0}), settings), {.nearPlane = 0.1}))
      REQUIRE(value >= 0.9999f);  // ranks share the depth buffer's digits
  }
}

TEST_CASE("overlays keep the caller's depth, but counted overlaps have far depth") {
  const Stage stage(testDevice(), makeScene(place(3)));
  const Camera view = cameraAt({0.45, 0.3, 0.2}, 0.05);
  RenderSettings settings = withTiers();
  const std::vector<float> plain = depthOf(stage, stage.plan(view, settings), {.nearPlane = 0.1});
  settings.overlay = Overlay::tiers;
  CHECK(depthOf(stage, stage.plan(view, settings), {.nearPlane = 0.1}) == plain);
  settings.overlay = Overlay::overlap;
  for (const float value : depthOf(stage, stage.plan(view, settings), {.nearPlane = 0.1}))
    if (value != 1) FAIL(value);
}
