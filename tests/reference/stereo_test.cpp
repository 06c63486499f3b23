// SPDX-License-Identifier: Apache-2.0
// Plans with two eyes ([T] §2.5.4).
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>

#include "base/vulkan/barrier.h"
#include "base/vulkan/gpu_image.h"
#include "base/vulkan/submit.h"
#include "gpu/draw/multiview.h"
#include "gpu/transfer/readback.h"
#include "ibr/metrics.h"
#include "reference/compare_pictures.h"
#include "reference/stage.h"
#include "support/gpu.h"

using namespace ibr;
using namespace ibr::test;

namespace {

// Two eyes side by side, whose principal points are off-centre by `skew` px towards the nose.
std::vector<Camera> eyes(double ipd, double skew, double canting = 0) {
  std::vector<Camera> views{cameraAt({0.4, 0.2, 0.05}, 0.03), cameraAt({0.4, 0.2, 0.05}, 0.03)};
  for (int e = 0; e < 2; ++e) {
    const double side = e == 0 ? -1 : 1;
    views[e].pose.position += views[e].pose.rotation * glm::dvec3(side * 0.5 * ipd, 0, 0);
    views[e].pose.rotation *= glm::angleAxis(-side * canting, glm::dvec3(0, 1, 0));
    views[e].intrinsics.cx -= side * skew;
  }
  return views;
}

}  // namespace

TEST_CASE("each eye's image equals the reference implementation's, off-centre and dithered", "[multiview]") {
  SyntheticOptions options = place(4);
  options.cells = {{0, 1, 2}, {1, 2, 3}};
  const Stage stage(testDevice(), makeScene(options));
  RenderSettings settings = withTiers();
  settings.blend = BlendMode::dither;
  const FramePlan plan = planFrame(stage.scene(), sceneBounds(stage.scene()), {eyes(0.064, 21.3), settings});
  for (std::size_t view : {0u, 1u}) compareWithReference(stage, plan, 0.25, 0.4, view);
}

TEST_CASE("an eye's image equals the single-view image if the draw order is the same") {
  const Stage stage(testDevice(), makeScene(place(3)));
  const std::vector<Camera> views = eyes(0.064, 12);
  const FramePlan plan = planFrame(stage.scene(), sceneBounds(stage.scene()), {views, withTiers()});
  const std::vector<Image8> pictures = stage.renderViews(plan);
  for (int e = 0; e < 2; ++e) CHECK(pictures[e] == stage.render(views[e], withTiers()));
}

TEST_CASE("distant content has the same dither pattern in both eyes") {
  SyntheticOptions options = place(3);
  options.atInfinity = true;
  SyntheticScene made = makeScene(options);
  // Different photographs, so that dithering causes grain.
  for (std::size_t i = 0; i < made.photographs.size(); ++i)
    for (std::uint8_t& value : made.photographs[i].values) value = std::uint8_t(value / 2 + 50 * i);
  const Stage stage(testDevice(), made);
  RenderSettings settings = withTiers();
  settings.blend = BlendMode::dither;
  struct Row {
    double skew, canting;
    int shift;  // px from a far point in the left image to the same point in the right one
  };
  // Displays turned outwards: with equal focal lengths the pattern matches only in the middle.
  const double focal = eyes(0, 0)[0].intrinsics.fx;
  for (const Row& row : {Row{0, 0, 0}, Row{21, 0, -42}, Row{0, std::atan(10 / focal), -20}}) {
    // A distance so small that both eyes have nearly the same weights.
    const FramePlan plan =
        planFrame(stage.scene(), sceneBounds(stage.scene()), {eyes(0.002, row.skew, row.canting), settings});
    const std::vector<Image8> pictures = stage.renderViews(plan);
    RenderSettings blended = settings;
    blended.blend = BlendMode::blend;
    FramePlan plain = plan;
    plain.settings = blended;
    const std::vector<Image8> smooth = stage.renderViews(plain);
    // Grain: the difference that dithering causes, compared around the middle of the left image.
    std::size_t grain = 0, differs = 0;
    for (int y = 100; y < 140; ++y)
      for (int x = 130; x < 190; ++x) {
        const int left = pictures[0].pixel(x, y)[0] - smooth[0].pixel(x, y)[0];
        const int right = pictures[1].pixel(x + row.shift, y)[0] - smooth[1].pixel(x + row.shift, y)[0];
        grain += std::abs(left) > 12;
        differs += std::abs(left - right) > 12;
      }
    INFO("skew " << row.skew << ", canting " << row.canting);
    CHECK(grain > 300);
    CHECK(double(differs) < 0.15 * double(grain));
  }
}

TEST_CASE("targets of both eyes may be layers of one image, and each layer is written separately") {
  const Stage stage(testDevice(), makeScene(place(3)));
  const FramePlan plan = planFrame(stage.scene(), sceneBounds(stage.scene()), {eyes(0.064, 12), withTiers()});
  const VkExtent2D extent{320, 240};
  const Renderer renderer(testDevice(), stage.gpuScene(), {.maxExtent = extent, .maxViews = 2, .depth = true});
  const auto layered = [&](VkFormat format, VkImageUsageFlags usage, VkImageAspectFlags aspect) {
    return GpuImage(testDevice(),
                    {.format = format,
                     .extent = extent,
                     .layers = 2,
                     .usage = usage,
                     .aspect = aspect,
                     .viewType = VK_IMAGE_VIEW_TYPE_2D_ARRAY},
                    "eyes");
  };
  const GpuImage colour =
      layered(VK_FORMAT_R8G8B8A8_UNORM, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
              VK_IMAGE_ASPECT_COLOR_BIT);
  const GpuImage depth =
      layered(VK_FORMAT_D32_SFLOAT, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, VK_IMAGE_ASPECT_DEPTH_BIT);
  std::array<ImageViewHandle, 2> colourViews, depthViews;
  std::array<Target, 2> targets;
  for (std::uint32_t eye = 0; eye < 2; ++eye) {
    colourViews[eye] = makeLayerView(testDevice(), colour, eye);
    depthViews[eye] = makeLayerView(testDevice(), depth, eye);
    targets[eye] = {.image = colour.get(),
                    .view = colourViews[eye].get(),
                    .format = VK_FORMAT_R8G8B8A8_UNORM,
                    .extent = extent,
                    // The validation layer reports an error if the right eye's barriers repeat the left eye's.
                    .initialUse = eye == 0 ? use::kUndefined : use::kColourAttachment,
                    .finalUse = use::kTransferSource,
                    .depth = DepthTarget{.image = depth.get(),
                                         .view = depthViews[eye].get(),
                                         .initialUse = eye == 0 ? use::kUndefined : use::kDepthAttachment,
                                         .finalUse = use::kDepthAttachment,
                                         .layer = eye},
                    .layer = eye};
  }
  submitAndWait(testDevice(), [&](VkCommandBuffer commands) {
    const auto first = [&](const GpuImage& image, ImageUse to, VkImageAspectFlags aspect) {
      transition(commands, image.get(), use::kUndefined, to, VkImageSubresourceRange{aspect, 0, 1, 1, 1});
    };
    first(colour, use::kColourAttachment, VK_IMAGE_ASPECT_COLOR_BIT);
    first(depth, use::kDepthAttachment, VK_IMAGE_ASPECT_DEPTH_BIT);
    renderer.record(commands, plan, targets);
  });
  const std::vector<Image8> alone = stage.renderViews(plan);
  for (std::uint32_t eye = 0; eye < 2; ++eye) {
    const std::vector<std::byte> bytes =
        readImage(testDevice(), colour.get(), extent, 4, use::kTransferSource, VK_IMAGE_ASPECT_COLOR_BIT, eye);
    CHECK((std::memcmp(bytes.data(), alone[eye].values.data(), bytes.size()) == 0));
  }
}

TEST_CASE("multiview is probed, and pixels of both eyes are equal with and without multiview", "[multiview]") {
  const bool works = multiviewWorks(testDevice());
  const std::string name = testDevice().name();
  INFO(name);
  if (name.find("Mesa 22.3.6") != std::string::npos && name.find("llvmpipe") != std::string::npos) CHECK_FALSE(works);

  SyntheticOptions options = place(4);
  options.cells = {{0, 1, 2}, {1, 2, 3}};
  const Stage stage(testDevice(), makeScene(options));
  RenderSettings settings = withTiers();
  settings.maxTier = kTierFilled;
  settings.blend = BlendMode::mixed;
  settings.colourMapping = ColourMapping::ours;
  const FramePlan plan = planFrame(stage.scene(), sceneBounds(stage.scene()), {eyes(0.064, 12), settings});
  const auto rendered = [&](bool multiview) {
    const VkExtent2D extent{320, 240};
    RendererOptions needed = optionsFor(settings, extent);
    needed.maxViews = 2;
    needed.depth = true;
    needed.multiview = multiview;
    const Renderer renderer(testDevice(), stage.gpuScene(), needed);
    REQUIRE(renderer.supports(plan));
    const auto counters = renderer.count(plan);
    Offscreen left(testDevice(), extent), right(testDevice(), extent);
    const Target targets[]{left.target(), right.target()};
    std::vector<Image8> pictures{
        left.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, targets); })};
    pictures.push_back(right.render([](VkCommandBuffer) {}));
    return std::pair(pictures, counters);
  };
  const auto [twice, twiceCounters] = rendered(false);
  const auto [once, onceCounters] = rendered(true);
  CHECK(once == twice);
  CHECK(onceCounters.passes == twiceCounters.passes - (works ? 1 : 0));
  CHECK((onceCounters.draws < twiceCounters.draws) == works);
  CHECK((onceCounters.pipelines > twiceCounters.pipelines) == works);
  CHECK((onceCounters.workingBytes > twiceCounters.workingBytes) == works);
}
