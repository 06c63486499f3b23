// SPDX-License-Identifier: Apache-2.0
// The caller's polygons in the scene ([T] §2.5.5): hidden exactly where the scene is nearer.
#include <catch2/catch.hpp>
#include <cmath>

#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/gpu_image.h"
#include "base/vulkan/pipeline.h"
#include "base/vulkan/rendering.h"
#include "reference/stage.h"
#include "shaders/composite_vert.h"
#include "shaders/test_white_frag.h"
#include "support/gpu.h"

using namespace ibr;
using namespace ibr::test;

TEST_CASE("a polygon is hidden only where the scene is nearer") {
  SyntheticOptions options = place(4);
  options.cells = {{0, 1, 2}, {1, 2, 3}, {0, 3}};
  const Stage stage(testDevice(), makeScene(options));
  const Camera view = cameraAt({0.45, 0.3, 0.2}, 0.05);
  const FramePlan plan = stage.plan(view, withTiers());
  const Image8 plain = stage.render(plan);
  const ImageF truth = renderDepth(stage.place(), view);
  constexpr VkExtent2D kExtent{320, 240};
  constexpr double kNear = 0.1;

  const Renderer renderer(testDevice(), stage.gpuScene(), {.maxExtent = kExtent, .depth = true});
  Offscreen offscreen(testDevice(), kExtent);
  const GpuImage depth(testDevice(),
                       {.format = VK_FORMAT_D32_SFLOAT,
                        .extent = kExtent,
                        .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT,
                        .aspect = VK_IMAGE_ASPECT_DEPTH_BIT},
                       "caller's depth");
  const PipelineLayoutHandle layout = makePipelineLayout(testDevice(), {}, {});
  const VkFormat format = VK_FORMAT_R8G8B8A8_UNORM;
  const PipelineHandle polygon = makeGraphicsPipeline(testDevice(), {.name = "polygon",
                                                                     .vertex = shaders::composite_vert,
                                                                     .fragment = shaders::test_white_frag,
                                                                     .layout = layout.get(),
                                                                     .colourFormats = {&format, 1},
                                                                     .depthFormat = VK_FORMAT_D32_SFLOAT,
                                                                     .depthTest = true});
  for (const double distance : {2.0, 6.0, 20.0}) {  // before the board at 4, between board and wall at 8, behind both
    Target target = offscreen.target();
    target.finalUse = use::kColourAttachment;
    target.depth = DepthTarget{.image = depth.get(), .view = depth.view(), .nearPlane = kNear};
    const Image8 picture = offscreen.render([&](VkCommandBuffer commands) {
      renderer.record(commands, plan, target);
      const VkRenderingAttachmentInfo colour = colourAttachment(target.view, VK_ATTACHMENT_LOAD_OP_LOAD);
      const VkRenderingAttachmentInfo tested =
          depthAttachment(depth.view(), VK_ATTACHMENT_LOAD_OP_LOAD, VK_ATTACHMENT_STORE_OP_STORE);
      beginRendering(commands, kExtent, {&colour, 1}, &tested);
      const auto z = float(1 - kNear / distance);  // for an infinite far plane
      const VkViewport viewport{0, 0, float(kExtent.width), float(kExtent.height), z, z};
      vkCmdSetViewport(commands, 0, 1, &viewport);
      vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, polygon.get());
      vkCmdDraw(commands, 3, 1, 0, 0);
      vkCmdEndRendering(commands);
      transition(commands, target.image, use::kColourAttachment, use::kTransferSource);
    });
    std::size_t hidden = 0, visible = 0, wrong = 0, changed = 0;
    for (int y = 0; y < plain.height; ++y)
      for (int x = 0; x < plain.width; ++x) {
        const auto pixel = picture.pixel(x, y);
        const bool shown = pixel[0] == 255 && pixel[1] == 255 && pixel[2] == 255;
        const bool nearer = plain.pixel(x, y)[3] != 0 && truth.pixel(x, y)[0] < distance;
        ++(shown ? visible : hidden);
        wrong += shown == nearer;
        if (!shown)
          for (int c = 0; c < 3; ++c) changed += pixel[c] != plain.pixel(x, y)[c];
      }
    INFO("polygon at " << distance);
    // The mesh's grid cuts the board's border inexactly, so some pixels may differ from the truth.
    CHECK(double(wrong) < 0.01 * double(hidden + visible));
    CHECK(changed == 0);
    if (distance == 2) CHECK(hidden == 0);
    if (distance == 6) CHECK(hidden > 3000);
    if (distance == 20) CHECK(hidden > 30000);
    CHECK(visible > 10000);
  }
}
