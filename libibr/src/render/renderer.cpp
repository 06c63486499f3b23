// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>

#include "gpu/canvas.h"
#include "gpu/scope.h"
#include "gpu/submit.h"
#include "ibr/renderer.h"
#include "render/cell_pass.h"
#include "render/colour_map_pass.h"
#include "render/colour_plan.h"
#include "render/colour_tables.h"
#include "render/composite_pass.h"
#include "render/depth_pass.h"
#include "render/fill_pass.h"
#include "render/gpu_scene.h"
#include "render/steps.h"

namespace ibr {

struct Renderer::State {
  State(Device& device, const GpuScene& gpuScene, const RendererOptions& o)
      : scene(&gpuScene.state()),
        options(o),
        requirements(withOptions(scene->requirements, o)),
        canvas(device, scaled(o.largest, o.largestScale),
               ColourMapPass::canvasUse(requirements.colourSequence ? ColourSupport::all : ColourSupport::off)) {
    const Requirements& needed = requirements;
    if (needed.switchMixing) former.emplace(device, canvas.largest());
    if (needed.fill) fill.emplace(device, canvas);
    if (needed.colourTables) tables.emplace(device, std::min(needed.cells, kLargestCellCount));
    cells.emplace(device, gpuScene, canvas.renderPass(), o, needed, tables ? tables->tables() : VK_NULL_HANDLE);
    if (tables) colours.emplace(device, *tables, *cells, canvas, o);
    composite.emplace(device, canvas, former ? &*former : nullptr, fill ? &*fill : nullptr, o);
    if (needed.depth) depth.emplace(device, canvas);
    // The composition has all its images bound, also in a frame that does not draw them; they are in the layout they
    // are bound with from here on.
    submitAndWait(device, [&](VkCommandBuffer commands) {
      for (const Canvas* image : {&canvas, former ? &*former : nullptr}) {
        if (!image) continue;
        image->begin(commands, image->largest(), {0, 0, 0, 0});
        image->end(commands);
      }
      if (fill) fill->record(commands, canvas.largest());
    });
  }

  // What of a plan this renderer can show.
  bool mixes(const FramePlan& plan) const { return former && plan.formerWeight > 0; }
  bool fills(const FramePlan& plan) const { return fill && plan.settings.lowestTier >= kTierFilled; }
  // Of the picture in the canvas.
  VkExtent2D drawn(const FramePlan& plan, VkExtent2D target) const {
    return scaled(target, options.largestScale > 0 ? std::min(plan.settings.renderScale, options.largestScale) : 0);
  }
  static VkExtent2D scaled(VkExtent2D extent, double scale) {  // 0: as it is
    if (scale == 0) return extent;
    const auto side = [&](std::uint32_t n) { return std::max(1u, std::uint32_t(std::lround(n * scale))); };
    return {side(extent.width), side(extent.height)};
  }

  const GpuScene::State* scene;
  RendererOptions options;
  Requirements requirements;
  Canvas canvas;
  std::optional<Canvas> former;
  std::optional<FillPass> fill;
  std::optional<ColourTables> tables;
  std::optional<CellPass> cells;
  std::optional<ColourMapPass> colours;
  std::optional<CompositePass> composite;
  std::optional<DepthPass> depth;
};

Renderer::Renderer(Device& device, const GpuScene& scene, const RendererOptions& options)
    : state_(std::make_unique<State>(device, scene, options)) {}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

bool Renderer::supports(VkFormat format) noexcept {
  return CompositePass::supports(format);
}

void Renderer::record(VkCommandBuffer commandBuffer, const FramePlan& plan, std::span<const Target> targets,
                      ScopeTimer* timer) const noexcept {
  const State& s = *state_;
  const ColourMapping mapping = s.colours ? plan.settings.colourMapping : ColourMapping::off;
  const bool sequence = mapping == ColourMapping::paper || mapping == ColourMapping::paperRedraw;
  assert(!sequence || s.options.colour == ColourSupport::all);
  assert(targets.size() == plan.views.size() && targets.size() <= s.options.views);
  s.cells->update(commandBuffer, plan);
  for (std::size_t view = 0; view < targets.size(); ++view) {
    const Target& target = targets[view];
    const VkExtent2D extent = s.drawn(plan, target.extent);
    assert(!target.depth || s.depth);
    assert(target.extent.width <= s.options.largest.width && target.extent.height <= s.options.largest.height);
    assert(int(target.extent.width) == plan.views[view].intrinsics.width &&
           int(target.extent.height) == plan.views[view].intrinsics.height);
    if (mapping == ColourMapping::ours && (view == 0 || !eyesShare(plan))) {
      const GpuScope scope(commandBuffer, timer, "colour tables");
      s.colours->makeTables(commandBuffer, plan, view, extent);
    }
    const auto drawInto = [&](const Canvas& canvas, Order order, const char* name) {
      const GpuScope scope(commandBuffer, timer, name);
      canvas.begin(commandBuffer, extent, {0, 0, 0, 0});
      s.cells->draw(commandBuffer, plan, order, view, extent);
      canvas.end(commandBuffer);
    };
    if (sequence && view == 0) {
      const GpuScope scope(commandBuffer, timer, "canvas");
      s.colours->drawSequence(commandBuffer, plan, extent);
    } else {
      drawInto(s.canvas, Order::current, "canvas");
    }
    if (s.mixes(plan)) drawInto(*s.former, Order::former, "former canvas");
    if (s.fills(plan)) {
      const GpuScope scope(commandBuffer, timer, "fill");
      s.fill->record(commandBuffer, extent);
    }
    if (target.depth) {
      const GpuScope scope(commandBuffer, timer, "depth");
      const bool hasDepth = plan.settings.order == DrawOrder::ours;
      const std::uint32_t steps = hasDepth ? stepsOf(*s.scene, plan, Order::current, view).count : 0;
      s.depth->record(commandBuffer, steps, plan.nearDistance, extent, target.extent, *target.depth);
    }
    const GpuScope scope(commandBuffer, timer, "composite");
    s.composite->record(commandBuffer, plan.settings, extent, s.mixes(plan) ? float(plan.formerWeight) : 0.0f,
                        s.fills(plan), target);
  }
}

Renderer::Counters Renderer::count(const FramePlan& plan) const noexcept {
  const State& s = *state_;
  Counters counters;
  counters.pipelines = s.cells->pipelineCount() + s.composite->pipelineCount();
  counters.workingBytes = s.canvas.allocatedBytes();
  counters.bytes = {.canvases = s.canvas.bytes() * (s.former ? 2 : 1),
                    .fill = s.fill ? s.fill->bytes() : 0,
                    .colours = s.colours ? s.colours->bytes() : 0,
                    .parameters = s.cells->parameterBytes(),
                    .noise = s.cells->noiseBytes()};
  const auto drawn = [&](std::size_t view) {
    const Intrinsics& k = plan.views[view].intrinsics;
    return s.drawn(plan, {std::uint32_t(k.width), std::uint32_t(k.height)});
  };
  if (s.former) counters.workingBytes += s.former->allocatedBytes();
  if (s.depth) counters.pipelines += s.depth->pipelineCount();
  if (s.fill) {
    counters.pipelines += FillPass::kPipelineCount;
    counters.workingBytes += s.fill->allocatedBytes();
  }
  if (s.colours) {
    counters.pipelines += s.colours->pipelineCount();
    counters.workingBytes += s.colours->imageBytes();
    s.colours->count(plan, drawn(0), counters);
  }
  for (std::size_t view = 0; view < plan.views.size(); ++view) {
    if (s.fills(plan)) counters.dispatches += FillPass::dispatchCount(drawn(view));
    ++counters.passes;  // the composition, a triangle
    ++counters.draws;
    ++counters.triangles;
    for (const Order order : {Order::current, Order::former}) {
      if (order == Order::former && !s.mixes(plan)) continue;
      ++counters.passes;
      const Steps steps = stepsOf(*s.scene, plan, order, view);
      for (const Step& step : steps.all()) {
        if (step.hidden) continue;
        ++counters.draws;
        counters.triangles += step.range.indexCount / 3;
      }
    }
  }
  return counters;
}

}  // namespace ibr
