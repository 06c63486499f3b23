// SPDX-License-Identifier: Apache-2.0
#include "gpu/draw/multiview.h"

#include "base/vulkan/functions.h"
#include "base/vulkan/pipeline.h"
#include "base/vulkan/rendering.h"
#include "base/vulkan/submit.h"
#include "gpu/device/multiview_answer.h"
#include "gpu/draw/canvas.h"
#include "gpu/transfer/readback.h"
#include "shaders/multiview_probe_frag.h"
#include "shaders/multiview_probe_vert.h"

namespace ibr {

bool runMultiviewProbe(const Device& device) {
  if (!device.supportsMultiview()) return false;
  // shaders/gpu/multiview_probe.vert: view v draws the squares (x, y) of 2×2 pixels with x and y of v's parity, and a
  // large triangle behind them. The triangle is essential: lavapipe misplaces clipped triangles.
  constexpr std::uint32_t kSquares = 4, kBehind = 4, kSide = 8;
  constexpr VkExtent2D kExtent{kSide, kSide};
  const Canvas canvas(device, kExtent, 0, 2);
  const PipelineLayoutHandle layout = makePipelineLayout(device, {}, {});
  const PipelineHandle pipeline = makeGraphicsPipeline(device, {.name = "multiview probe",
                                                                .vertex = shaders::multiview_probe_vert,
                                                                .fragment = shaders::multiview_probe_frag,
                                                                .layout = layout.get(),
                                                                .renderPass = canvas.renderPass(),
                                                                .depthTest = true,
                                                                .depthWrite = true});
  submitAndWait(device, [&](VkCommandBuffer commands) {
    canvas.begin(commands, kExtent, {0, 0, 0, 0});
    setViewport(commands, kExtent);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline.get());
    vkCmdDraw(commands, 3, 1, 0, kBehind);
    for (std::uint32_t square = 0; square < kSquares; ++square) vkCmdDraw(commands, 6, 1, 0, square);
    vkCmdDraw(commands, 3, 1, 0, kBehind);
    canvas.end(commands);
  });
  for (std::uint32_t view = 0; view < 2; ++view) {
    const std::vector<std::byte> pixels =
        readImage(device, canvas.colour(), kExtent, 4, use::kSampled, VK_IMAGE_ASPECT_COLOR_BIT, view);
    for (std::uint32_t y = 0; y < kSide; ++y)
      for (std::uint32_t x = 0; x < kSide; ++x) {
        const bool inSquare = x / 2 % 2 == view && y / 2 % 2 == view;
        const std::uint32_t drawn = inSquare ? x / 4 + 2 * (y / 4) : kBehind;
        const std::byte* pixel = &pixels[4 * (y * kSide + x)];
        if (std::uint32_t(pixel[0]) != view + 1 || std::uint32_t(pixel[1]) != drawn + 1) return false;
      }
  }
  return true;
}

bool multiviewWorks(const Device& device) {
  std::optional<bool>& answer = multiviewAnswer(device);
  if (!answer) answer = runMultiviewProbe(device);
  return *answer;
}

bool multiviewIsKnownToWork(const Device& device) noexcept {
  return multiviewAnswer(device).value_or(false);
}

}  // namespace ibr
