// SPDX-License-Identifier: Apache-2.0
#include "batch/scene_renderer.h"

#include <algorithm>
#include <chrono>

#include "base/check.h"

namespace ibr::app {
namespace {

VkExtent2D largestOf(const std::vector<View>& views) {
  VkExtent2D largest{1, 1};
  for (const View& view : views) {
    largest.width = std::max(largest.width, std::uint32_t(view.camera.intrinsics.width));
    largest.height = std::max(largest.height, std::uint32_t(view.camera.intrinsics.height));
  }
  return largest;
}

}  // namespace

SceneRenderer::SceneRenderer(const Scene& scene, const std::vector<View>& views, const RenderSettings& settings,
                             const Context& context)
    : scene_(scene),
      bounds_(sceneBounds(scene)),
      device_(Device::create({.device = context.options().device, .log = context.log()})),
      gpuScene_(device_, scene),
      renderer_(device_, gpuScene_, optionsFor(settings, largestOf(views))) {}

Offscreen& SceneRenderer::offscreen(int width, int height) {
  const VkExtent2D extent{std::uint32_t(width), std::uint32_t(height)};
  if (!offscreen_ || offscreen_->target().extent.width != extent.width ||
      offscreen_->target().extent.height != extent.height) {
    offscreen_.reset();  // first, so that there is never memory for two
    offscreen_.emplace(device_, extent);
  }
  return *offscreen_;
}

SceneRenderer::Picture SceneRenderer::render(const Camera& view, const RenderSettings& settings, PlanState& state,
                                             double dtSeconds) {
  Offscreen& output = offscreen(view.intrinsics.width, view.intrinsics.height);
  const auto begin = std::chrono::steady_clock::now();
  const FramePlan plan = planFrame(scene_, bounds_, {{view}, settings, dtSeconds}, state);
  state = plan.next;
  Picture picture;
  picture.image =
      output.render([&](VkCommandBuffer commandBuffer) { renderer_.record(commandBuffer, plan, output.target()); });
  picture.milliseconds = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  return picture;
}

}  // namespace ibr::app
