// SPDX-License-Identifier: Apache-2.0
#include "shared/draw/scene_renderer.h"

#include <algorithm>
#include <chrono>

#include "shared/draw/graph_lines.h"

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

GpuSceneOptions batchOptions(GpuSceneOptions options, const Context& context) {
  options.log = context.log();
  options.readerThreads = 0;
  return options;
}

SceneRenderer::SceneRenderer(const Scene& scene, const std::vector<View>& views, const GpuSceneOptions& gpuScene,
                             RendererOptions options, const Context& context)
    : scene_(scene),
      bounds_(sceneBounds(scene)),
      device_(Device::create({.device = context.options().device, .log = context.log()})),
      gpuScene_(device_, scene, batchOptions(gpuScene, context)),
      renderer_(device_, gpuScene_, (options.maxExtent = largestOf(views), options)),
      wantsBuffers_(options.bufferScene != nullptr) {}

void SceneRenderer::showGraph() {
  graph_ = graphLines(device_, scene_, VK_FORMAT_R8G8B8A8_UNORM);
}

void SceneRenderer::prepare(std::size_t eye, const Intrinsics& intrinsics) {
  const VkExtent2D extent{std::uint32_t(intrinsics.width), std::uint32_t(intrinsics.height)};
  std::optional<Offscreen>& offscreen = offscreen_[eye];
  if (offscreen && offscreen->target().extent.width == extent.width &&
      offscreen->target().extent.height == extent.height)
    return;
  offscreen.reset();  // freed first, so that only one target takes memory at a time
  buffers_[eye].reset();
  offscreen.emplace(device_, extent);
  if (wantsBuffers_) buffers_[eye].emplace(device_, extent);
}

SceneRenderer::Picture SceneRenderer::render(const Camera& view, const RenderSettings& settings, PlanState& state,
                                             double dtSeconds) {
  return render(std::vector{view}, settings, state, dtSeconds).front();
}

std::vector<SceneRenderer::Picture> SceneRenderer::render(const std::vector<Camera>& views,
                                                          const RenderSettings& settings, PlanState& state,
                                                          double dtSeconds) {
  std::vector<Target> targets;
  for (std::size_t eye = 0; eye < views.size(); ++eye) {
    prepare(eye, views[eye].intrinsics);
    targets.push_back(offscreen_[eye]->target());
  }
  const auto begin = std::chrono::steady_clock::now();
  const FramePlan plan = planFrame(scene_, bounds_, {views, settings, dtSeconds}, state);
  state = plan.next;
  streamAll(device_, gpuScene_, plan, frame_);
  std::vector<Picture> pictures(views.size());
  pictures[0].image = offscreen_[0]->render([&](VkCommandBuffer commandBuffer) {
    renderer_.record(commandBuffer, plan, targets);
    if (graph_) recordGraph(commandBuffer, *graph_, plan, targets);
  });
  for (std::size_t eye = 1; eye < views.size(); ++eye)  // the first eye was drawn above
    pictures[eye].image = offscreen_[eye]->render([](VkCommandBuffer) {});
  const double milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  for (std::size_t eye = 0; eye < views.size(); ++eye) {
    pictures[eye].milliseconds = milliseconds;
    if (wantsBuffers_)
      pictures[eye].buffers = buffers_[eye]->render([&](VkCommandBuffer commandBuffer) {
        renderer_.recordBuffers(commandBuffer, plan, eye, buffers_[eye]->targets());
      });
  }
  return pictures;
}

}  // namespace ibr::app
