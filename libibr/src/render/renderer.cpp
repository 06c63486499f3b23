// SPDX-License-Identifier: Apache-2.0
#include <cassert>

#include "gpu/canvas.h"
#include "gpu/submit.h"
#include "ibr/renderer.h"
#include "render/cell_pass.h"
#include "render/composite_pass.h"
#include "render/gpu_scene.h"
#include "render/steps.h"

namespace ibr {

struct Renderer::State {
  State(Device& device, const GpuScene& gpuScene, VkExtent2D size, std::uint32_t views)
      : scene(&gpuScene.state()),
        largest(size),
        largestViews(views),
        canvas(device, size),
        former(device, size),
        cells(device, gpuScene, canvas.renderPass(), views),
        composite(device, canvas, former) {
    // The composition always has both canvases bound; one that is not drawn is in the layout it is bound with.
    submitAndWait(device, [&](VkCommandBuffer commands) {
      former.begin(commands, size, {0, 0, 0, 0});
      former.end(commands);
    });
  }

  const GpuScene::State* scene;
  VkExtent2D largest;
  std::uint32_t largestViews;
  Canvas canvas, former;
  CellPass cells;
  CompositePass composite;
};

Renderer::Renderer(Device& device, const GpuScene& scene, VkExtent2D largest, std::uint32_t views)
    : state_(std::make_unique<State>(device, scene, largest, views)) {}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

bool Renderer::supports(VkFormat format) noexcept {
  return CompositePass::supports(format);
}

void Renderer::record(VkCommandBuffer commandBuffer, const FramePlan& plan,
                      std::span<const Target> targets) const noexcept {
  const State& s = *state_;
  assert(targets.size() == plan.views.size() && targets.size() <= s.largestViews);
  s.cells.update(commandBuffer, plan);
  for (std::size_t view = 0; view < targets.size(); ++view) {
    const Target& target = targets[view];
    assert(target.extent.width <= s.largest.width && target.extent.height <= s.largest.height);
    assert(int(target.extent.width) == plan.views[view].intrinsics.width &&
           int(target.extent.height) == plan.views[view].intrinsics.height);
    const auto drawInto = [&](const Canvas& canvas, Order order) {
      canvas.begin(commandBuffer, target.extent, {0, 0, 0, 0});
      s.cells.draw(commandBuffer, plan, order, view, target.extent);
      canvas.end(commandBuffer);
    };
    drawInto(s.canvas, Order::current);
    if (plan.formerWeight > 0) drawInto(s.former, Order::former);
    s.composite.record(commandBuffer, plan.settings, float(plan.formerWeight), target);
  }
}

Renderer::Counters Renderer::count(const FramePlan& plan) const noexcept {
  const State& s = *state_;
  Counters counters;
  counters.pipelines = s.cells.pipelineCount() + s.composite.pipelineCount();
  counters.canvasBytes = s.canvas.allocatedBytes() + s.former.allocatedBytes();
  for (std::size_t view = 0; view < plan.views.size(); ++view)
    for (const Order order : {Order::current, Order::former}) {
      if (order == Order::former && plan.formerWeight <= 0) continue;
      counters.passes += order == Order::current ? 2 : 1;  // a canvas each, and the composition
      const Steps steps = stepsOf(*s.scene, plan, order, view);
      for (const Step& step : steps.all()) {
        ++counters.draws;
        counters.triangles += step.range.indexCount / 3;
      }
    }
  counters.draws += std::uint32_t(plan.views.size());  // the compositions
  counters.triangles += plan.views.size();
  return counters;
}

}  // namespace ibr
