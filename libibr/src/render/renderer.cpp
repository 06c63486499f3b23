// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cassert>
#include <optional>

#include "gpu/canvas.h"
#include "gpu/multiview.h"
#include "gpu/submit.h"
#include "ibr/renderer.h"
#include "render/buffer_pass.h"
#include "render/cell_pass.h"
#include "render/colour_map_pass.h"
#include "render/colour_tables.h"
#include "render/composite_pass.h"
#include "render/depth_pass.h"
#include "render/fill_pass.h"
#include "render/gpu_scene.h"
#include "render/steps.h"
#include "render/wireframe_pass.h"

namespace ibr {

struct Renderer::State {
  State(Device& device, const GpuScene& gpuScene, const RendererOptions& o)
      : scene(&gpuScene.state()), options(o), canvas(device, o.largest, ColourMapPass::canvasUse(o.colour)) {
    if (o.switchMixing) former.emplace(device, o.largest);
    if (o.views == 2 && o.multiview && multiviewWorks(device)) eyes.emplace(device, o.largest, 0, 2);
    if (o.fill) fill.emplace(device, canvas, eyesOrNull());
    if (o.colour != ColourSupport::off && scene->cells.size() > 1)  // one cell has nothing to adapt to
      tables.emplace(device, std::min(std::uint32_t(scene->cells.size()), kLargestCellCount));
    cells.emplace(device, gpuScene, canvas.renderPass(), o.views, tables ? tables->tables() : VK_NULL_HANDLE,
                  eyes ? eyes->renderPass() : VK_NULL_HANDLE);
    if (tables) colours.emplace(device, *tables, *cells, canvas, o.colour);
    composite.emplace(device, canvas, eyesOrNull(), former ? &*former : nullptr, fill ? &*fill : nullptr);
    if (o.depth) depth.emplace(device, canvas, eyesOrNull());
    if (o.wireframe) wireframe.emplace(device, *cells, canvas.renderPass(), tables.has_value());
    if (o.buffers) buffers.emplace(device, *o.buffers, *cells, canvas);
    // The composition has all its images bound, also in a frame that does not draw them; they are in the layout they
    // are bound with from here on.
    submitAndWait(device, [&](VkCommandBuffer commands) {
      const std::array<const Canvas*, 3> images{&canvas, former ? &*former : nullptr, eyesOrNull()};
      for (const Canvas* image : images) {
        if (!image) continue;
        image->begin(commands, o.largest, {0, 0, 0, 0});
        image->end(commands);
      }
      if (fill) fill->record(commands, o.largest);
    });
  }

  const Canvas* eyesOrNull() const { return eyes ? &*eyes : nullptr; }

  // What of a plan this renderer can show.
  bool mixes(const FramePlan& plan) const { return former && plan.formerWeight > 0; }
  bool drawsAtOnce(const FramePlan& plan) const {
    return eyes && plan.views.size() == 2 && !plan.settings.wireframe && !isSequence(plan) &&
           plan.views[0].intrinsics.width == plan.views[1].intrinsics.width &&
           plan.views[0].intrinsics.height == plan.views[1].intrinsics.height;
  }
  bool isSequence(const FramePlan& plan) const {
    return colours && (plan.settings.colourMapping == ColourMapping::paper ||
                       plan.settings.colourMapping == ColourMapping::paperRedraw);
  }
  bool fills(const FramePlan& plan) const { return fill && plan.settings.lowestTier >= kTierFilled; }

  const GpuScene::State* scene;
  RendererOptions options;
  Canvas canvas;
  std::optional<Canvas> former, eyes;  // the latter for both views at once
  std::optional<FillPass> fill;
  std::optional<ColourTables> tables;
  std::optional<CellPass> cells;
  std::optional<ColourMapPass> colours;
  std::optional<CompositePass> composite;
  std::optional<DepthPass> depth;
  std::optional<WireframePass> wireframe;
  std::optional<BufferPass> buffers;
};

Renderer::Renderer(Device& device, const GpuScene& scene, const RendererOptions& options)
    : state_(std::make_unique<State>(device, scene, options)) {}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

bool Renderer::supports(VkFormat format) noexcept {
  return CompositePass::supports(format);
}

void Renderer::record(VkCommandBuffer commandBuffer, const FramePlan& plan,
                      std::span<const Target> targets) const noexcept {
  const State& s = *state_;
  const ColourMapping mapping = s.colours ? plan.settings.colourMapping : ColourMapping::off;
  const bool sequence = s.isSequence(plan);
  assert(!sequence || s.options.colour == ColourSupport::all);
  assert(!plan.settings.wireframe || (s.wireframe && !sequence));
  assert(targets.size() == plan.views.size() && targets.size() <= s.options.views);
  s.cells->update(commandBuffer, plan);
  if (mapping == ColourMapping::ours) s.colours->makeTables(commandBuffer, plan, targets[0].extent);
  const bool atOnce = s.drawsAtOnce(plan);
  if (atOnce) {
    s.eyes->begin(commandBuffer, targets[0].extent, {0, 0, 0, 0});
    s.cells->drawEyes(commandBuffer, plan, targets[0].extent);
    s.eyes->end(commandBuffer);
  }
  for (std::size_t view = 0; view < targets.size(); ++view) {
    const Target& target = targets[view];
    const std::size_t source = atOnce ? kFromEyes + view : kFromCanvas;
    assert(!target.depth || s.depth);
    assert(target.extent.width <= s.options.largest.width && target.extent.height <= s.options.largest.height);
    assert(int(target.extent.width) == plan.views[view].intrinsics.width &&
           int(target.extent.height) == plan.views[view].intrinsics.height);
    const auto drawInto = [&](const Canvas& canvas, Order order) {
      canvas.begin(commandBuffer, target.extent, {0, 0, 0, 0});
      if (plan.settings.wireframe)
        s.wireframe->draw(commandBuffer, plan, order, view, target.extent);
      else
        s.cells->draw(commandBuffer, plan, order, view, target.extent);
      canvas.end(commandBuffer);
    };
    if (sequence && view == 0)
      s.colours->drawSequence(commandBuffer, plan, target.extent);
    else if (!atOnce)
      drawInto(s.canvas, Order::current);
    if (s.mixes(plan)) drawInto(*s.former, Order::former);
    if (s.fills(plan)) s.fill->record(commandBuffer, target.extent, source);
    if (target.depth) {
      const bool hasDepth = plan.settings.order == DrawOrder::ours;
      const std::uint32_t steps = hasDepth ? stepsOf(*s.scene, plan, Order::current, view).count : 0;
      s.depth->record(commandBuffer, source, steps, plan.nearDistance, target.extent, *target.depth);
    }
    s.composite->record(commandBuffer, source, plan, view, s.mixes(plan) ? float(plan.formerWeight) : 0.0f,
                        s.fills(plan), target);
  }
}

void Renderer::recordBuffers(VkCommandBuffer commandBuffer, const FramePlan& plan, std::size_t view,
                             const BufferTargets& targets) const noexcept {
  const State& s = *state_;
  assert(s.buffers && view < plan.views.size() && plan.views.size() <= s.options.views);
  assert(targets.extent.width <= s.options.largest.width && targets.extent.height <= s.options.largest.height);
  s.cells->update(commandBuffer, plan);
  s.buffers->record(commandBuffer, plan, view, targets);
}

Renderer::Counters Renderer::count(const FramePlan& plan) const noexcept {
  const State& s = *state_;
  Counters counters;
  counters.pipelines = s.cells->pipelineCount() + s.composite->pipelineCount();
  counters.workingBytes = s.canvas.allocatedBytes();
  if (s.eyes) counters.workingBytes += s.eyes->allocatedBytes();
  if (s.former) counters.workingBytes += s.former->allocatedBytes();
  if (s.depth) counters.pipelines += s.depth->pipelineCount();
  if (s.wireframe) counters.pipelines += s.wireframe->pipelineCount();
  if (s.buffers) {
    counters.pipelines += s.buffers->pipelineCount();
    counters.workingBytes += s.buffers->allocatedBytes();
  }
  if (s.fill) {
    counters.pipelines += FillPass::kPipelineCount;
    counters.workingBytes += s.fill->allocatedBytes();
  }
  if (s.colours) {
    counters.pipelines += s.colours->pipelineCount();
    counters.workingBytes += s.colours->imageBytes();
    s.colours->count(plan, counters);
  }
  for (std::size_t view = 0; view < plan.views.size(); ++view) {
    const Intrinsics& k = plan.views[view].intrinsics;
    if (s.fills(plan))
      counters.dispatches += FillPass::dispatchCount({std::uint32_t(k.width), std::uint32_t(k.height)});
    ++counters.passes;  // the composition, a triangle
    ++counters.draws;
    ++counters.triangles;
    for (const Order order : {Order::current, Order::former}) {
      if (order == Order::former && !s.mixes(plan)) continue;
      if (order == Order::current && view == 1 && s.drawsAtOnce(plan)) continue;  // with the first
      ++counters.passes;
      const Steps steps = stepsOf(*s.scene, plan, order, view);
      for (const Step& step : steps.all()) {
        ++counters.draws;
        counters.triangles += step.range.indexCount / 3;
      }
    }
  }
  return counters;
}

}  // namespace ibr
