// SPDX-License-Identifier: Apache-2.0
#include "runtime/scene_renderer.h"

#include <utility>

#include "ibr/error.h"
#include "support/calls.h"

namespace ibr::python {
namespace {

VkExtent2D extentOf(const Intrinsics& intrinsics) {
  return {std::uint32_t(intrinsics.width), std::uint32_t(intrinsics.height)};
}

}  // namespace

SceneRenderer::SceneRenderer(std::shared_ptr<const Scene> scene, const DeviceChoice& device,
                             const SceneRendererOptions& options)
    : planner_(unlocked([&] { return Planner(std::move(scene)); })),
      device_(unlocked([&] { return deviceOf(device); })) {
  const DeviceUse use(*device_);
  settings_ = options.settings.value_or(preset(Preset::balanced, device_->device.kind()));
  const Scene& drawn = *planner_.scene();
  options_ = optionsFor(settings_, options.maxExtent);
  options_.maxViews = options.stereo ? 2 : 1;
  options_.uncertaintyScene = &drawn;
  if (options.buffers) options_.bufferScene = &drawn;
  GpuSceneOptions gpuScene = options.gpuScene;
  gpuScene.log = logToPython();
  gpuScene.readerThreads = 0;  // images do not depend on timing
  try {
    gpuScene_.emplace(device_->device, drawn, gpuScene);
    renderer_.emplace(device_->device, *gpuScene_, options_);
  } catch (...) {
    gpuScene_.reset();  // while the device is locked
    throw;
  }
}

SceneRenderer::~SceneRenderer() {
  const DeviceUse use(*device_);
  buffers_.reset();
  offscreen_ = {};
  renderer_.reset();
  gpuScene_.reset();
}

std::uint64_t SceneRenderer::deviceBytes() const {
  const DeviceUse use(*device_);
  return gpuScene_->memory().sum();
}

void SceneRenderer::checkFits(const ScenePlan& plan) const {
  if (plan.scene != planner_.scene()) throw Error(ErrorCode::invalidInput, "plan: is of another scene");
  std::string exceeded;
  if (!renderer_->supports(plan.plan, &exceeded))
    throw Error(ErrorCode::invalidInput, "plan: the renderer was made for less (" + exceeded + ")");
}

template <class Images>
Images& SceneRenderer::sized(std::optional<Images>& images, const Intrinsics& intrinsics) {
  const VkExtent2D extent = extentOf(intrinsics);
  const auto current = [&] {
    if constexpr (std::is_same_v<Images, Offscreen>)
      return images->target().extent;
    else
      return images->targets().extent;
  };
  if (images && current().width == extent.width && current().height == extent.height) return *images;
  images.reset();  // freed first, so that only one takes memory at a time
  return images.emplace(device_->device, extent);
}

std::vector<Image8> SceneRenderer::images(const ScenePlan& plan) {
  const DeviceUse use(*device_);
  checkFits(plan);
  std::vector<Target> targets;
  for (std::size_t view = 0; view < plan.plan.views.size(); ++view)
    targets.push_back(sized(offscreen_[view], plan.plan.views[view].intrinsics).target());
  streamAll(device_->device, *gpuScene_, plan.plan, frame_);
  std::vector<Image8> images;
  for (std::size_t view = 0; view < targets.size(); ++view)
    images.push_back(offscreen_[view]->render([&](VkCommandBuffer commands) {
      if (view == 0) renderer_->record(commands, plan.plan, targets);  // draws all views
    }));
  return images;
}

FrameBuffers SceneRenderer::frameBuffers(const ScenePlan& plan, std::size_t view) {
  const DeviceUse use(*device_);
  checkFits(plan);
  if (!options_.bufferScene) throw Error(ErrorCode::invalidInput, "buffers: the renderer was made with buffers=False");
  if (view >= plan.plan.views.size())
    throw Error(ErrorCode::invalidInput,
                "view: " + std::to_string(view) + " is beyond the plan's " + std::to_string(plan.plan.views.size()));
  OffscreenBuffers& buffers = sized(buffers_, plan.plan.views[view].intrinsics);
  streamAll(device_->device, *gpuScene_, plan.plan, frame_);
  return buffers.render(
      [&](VkCommandBuffer commands) { renderer_->recordBuffers(commands, plan.plan, view, buffers.targets()); });
}

}  // namespace ibr::python
