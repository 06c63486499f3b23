// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <optional>

#include "base/check.h"
#include "gpu/draw/canvas.h"
#include "gpu/draw/multiview.h"
#include "gpu/draw/scope.h"
#include "gpu/transfer/submit.h"
#include "ibr/renderer.h"
#include "render/passes/buffer_pass.h"
#include "render/passes/cell_pass.h"
#include "render/passes/colour_map_pass.h"
#include "render/passes/colour_tables.h"
#include "render/passes/composite_pass.h"
#include "render/passes/depth_pass.h"
#include "render/passes/fill_pass.h"
#include "render/passes/gather_pass.h"
#include "render/passes/hidden_area_pass.h"
#include "render/passes/overlay_pass.h"
#include "render/passes/steps.h"
#include "render/passes/uncertainties.h"
#include "render/plan/colour_plan.h"
#include "render/resident/gpu_scene_state.h"

namespace ibr {

struct Renderer::State {
  State(Device& device, const GpuScene& gpuScene, const RendererOptions& o)
      : scene(&gpuScene.state()),
        options(o),
        requirements(withOptions(scene->requirements, o)),
        canvas(device, scaled(o.largest, canvasScale(o)),
               ColourMapPass::canvasUse(requirements.colourSequence ? ColourSupport::all : ColourSupport::off)) {
    const Requirements& needed = requirements;
    checkHiddenArea(o.hiddenArea);
    if (needed.switchMixing) former.emplace(device, canvas.largest());
    if (needed.multiview && multiviewWorks(device)) eyes.emplace(device, canvas.largest(), 0, 2);
    if (needed.fill) {
      std::vector<VkImageView> sources;
      for (const CanvasSource& source : sourcesOf(canvas, eyesOrNull())) sources.push_back(source.colour);
      fill.emplace(device, canvas.largest(), sources);
    }
    if (needed.colourTables) tables.emplace(device, std::min(needed.cells, kLargestCellCount));
    cells.emplace(device, gpuScene, canvas.renderPass(), o, needed, tables ? tables->tables() : VK_NULL_HANDLE,
                  eyes ? eyes->renderPass() : VK_NULL_HANDLE);
    if (needed.hiddenArea)
      hidden.emplace(device, o.hiddenArea, canvas.renderPass(), eyes ? eyes->renderPass() : VK_NULL_HANDLE);
    if (needed.gather) gather.emplace(device, gpuScene, canvas.renderPass(), canvas.largest(), o, needed);
    if (tables) colours.emplace(device, *tables, *cells, canvas, o);
    composite.emplace(device, canvas, eyesOrNull(), former ? &*former : nullptr, fill ? &*fill : nullptr, o,
                      needed.hiddenArea);
    if (needed.depth) depth.emplace(device, canvas, eyesOrNull(), needed.hiddenArea);
    if (const Scene* known = uncertaintiesFor(o)) uncertainties.emplace(device, *known, *scene);
    const Uncertainties* known = uncertainties ? &*uncertainties : nullptr;
    if (!needed.overlays.empty()) overlays.emplace(device, *cells, canvas.renderPass(), o, needed, known);
    if (needed.buffers) buffers.emplace(device, *cells, *known, canvas, needed);
    // The composition has all its images bound, also in a frame that does not draw them; they are in the layout they
    // are bound with from here on.
    submitAndWait(device, [&](VkCommandBuffer commands) {
      const std::array<const Canvas*, 3> images{&canvas, former ? &*former : nullptr, eyesOrNull()};
      for (const Canvas* image : images) {
        if (!image) continue;
        image->begin(commands, image->largest(), {0, 0, 0, 0});
        image->end(commands);
      }
      if (fill) fill->record(commands, canvas.largest(), kFromCanvas);
    });
  }

  const Canvas* eyesOrNull() const { return eyes ? &*eyes : nullptr; }

  bool has(Overlay overlay) const {
    return std::ranges::find(requirements.overlays, overlay) != requirements.overlays.end();
  }
  // The scene whose uncertainties something shows; null: nothing does.
  const Scene* uncertaintiesFor(const RendererOptions& o) const {
    if (!has(Overlay::confidence)) return o.buffers;
    check(o.uncertainties, ErrorCode::invalidInput,
          "renderer: Overlay::confidence needs RendererOptions::uncertainties");
    return o.uncertainties;
  }

  // What of a plan this renderer can show.
  bool mixes(const FramePlan& plan) const { return former && plan.formerWeight > 0; }
  bool drawsAtOnce(const FramePlan& plan) const {
    return eyes && !gathers(plan) && plan.views.size() == 2 && plan.settings.overlay == Overlay::none &&
           !isSequence(plan) && (!adapts(plan) || eyesShare(plan)) &&
           plan.views[0].intrinsics.width == plan.views[1].intrinsics.width &&
           plan.views[0].intrinsics.height == plan.views[1].intrinsics.height;
  }
  bool gathers(const FramePlan& plan) const { return gather && plan.settings.composition != Composition::cells; }
  bool adapts(const FramePlan& plan) const { return colours && plan.settings.colourMapping == ColourMapping::ours; }
  bool isSequence(const FramePlan& plan) const {
    return colours && (plan.settings.colourMapping == ColourMapping::paper ||
                       plan.settings.colourMapping == ColourMapping::paperRedraw);
  }
  bool hides(const FramePlan& plan) const {
    return hidden && plan.settings.leaveOutHidden && !cells->isPainters(plan.settings);
  }
  bool fills(const FramePlan& plan) const {
    return fill && plan.settings.lowestTier >= kTierFilled &&
           (plan.settings.overlay == Overlay::none || plan.settings.overlay == Overlay::wireframe);
  }

  // Fills the canvas, or with the first view the one for both eyes, and the former order's.
  void draw(VkCommandBuffer commands, const FramePlan& plan, std::size_t view, VkExtent2D extent,
            ScopeTimer* timer) const noexcept;
  void drawCells(VkCommandBuffer commands, const FramePlan& plan, Order order, std::size_t view,
                 VkExtent2D extent) const noexcept;

  // Of the picture in the canvas.
  VkExtent2D drawn(const FramePlan& plan, VkExtent2D target) const {
    return scaled(target, options.largestScale > 0 ? std::min(plan.settings.renderScale, options.largestScale) : 0);
  }
  // Buffers are drawn at their targets' size, with the canvas's depth.
  static double canvasScale(const RendererOptions& o) {
    return o.buffers && o.largestScale > 0 ? std::max(1.0, o.largestScale) : o.largestScale;
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
  std::optional<Canvas> former, eyes;  // the latter for both views at once
  std::optional<FillPass> fill;
  std::optional<ColourTables> tables;
  std::optional<CellPass> cells;
  std::optional<GatherPass> gather;
  std::optional<HiddenArea> hidden;
  std::optional<ColourMapPass> colours;
  std::optional<CompositePass> composite;
  std::optional<DepthPass> depth;
  std::optional<Uncertainties> uncertainties;
  std::optional<OverlayPass> overlays;
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

void Renderer::State::draw(VkCommandBuffer commands, const FramePlan& plan, std::size_t view, VkExtent2D extent,
                           ScopeTimer* timer) const noexcept {
  if (adapts(plan) && (view == 0 || !eyesShare(plan))) {
    const GpuScope scope(commands, timer, "colour tables");
    colours->makeTables(commands, plan, view, extent);
  }
  if (gathers(plan)) {
    const GpuScope scope(commands, timer, "vote");
    gather->update(commands, plan, view, extent);
    gather->vote(commands, plan, view, extent);
  }
  const bool atOnce = drawsAtOnce(plan);
  if (!atOnce || view == 0) {
    const GpuScope scope(commands, timer, "canvas");
    if (atOnce) {
      eyes->begin(commands, extent, {0, 0, 0, 0});
      if (hides(plan)) hidden->drawEyes(commands, plan, extent);
      cells->drawEyes(commands, plan, extent);
      eyes->end(commands);
    } else if (isSequence(plan) && view == 0) {
      colours->drawSequence(commands, plan, extent);
    } else {
      drawCells(commands, plan, Order::current, view, extent);
    }
  }
  if (!mixes(plan)) return;
  const GpuScope scope(commands, timer, "former canvas");
  drawCells(commands, plan, Order::former, view, extent);
}

void Renderer::State::drawCells(VkCommandBuffer commands, const FramePlan& plan, Order order, std::size_t view,
                                VkExtent2D extent) const noexcept {
  const Canvas& into = order == Order::current ? canvas : *former;
  into.begin(commands, extent, {0, 0, 0, 0});
  if (hides(plan)) hidden->draw(commands, plan, view, extent);
  if (plan.settings.overlay == Overlay::none)
    cells->draw(commands, plan, order, view, extent);
  else
    overlays->draw(commands, plan, order, view, extent);
  if (gathers(plan)) {
    const std::uint32_t steps = stepsOf(*scene, plan, order, view).count;
    if (plan.settings.overlay == Overlay::none)
      gather->draw(commands, plan, view, extent, steps);
    else
      gather->drawOverlay(commands, plan, view, extent, steps);
  }
  into.end(commands);
}

void Renderer::record(VkCommandBuffer commandBuffer, const FramePlan& plan, std::span<const Target> targets,
                      ScopeTimer* timer) const noexcept {
  const State& s = *state_;
  assert(!s.isSequence(plan) || s.options.colour == ColourSupport::all);
  assert(plan.settings.overlay == Overlay::none || (s.has(plan.settings.overlay) && !s.isSequence(plan)));
  assert(plan.settings.composition == Composition::cells || s.gather);
  assert(targets.size() == plan.views.size() && targets.size() <= s.options.views);
  s.cells->update(commandBuffer, plan);
  const bool atOnce = s.drawsAtOnce(plan);
  for (std::size_t view = 0; view < targets.size(); ++view) {
    const Target& target = targets[view];
    const VkExtent2D extent = s.drawn(plan, target.extent);
    const std::size_t source = atOnce ? kFromEyes + view : kFromCanvas;
    assert(!target.depth || s.depth);
    assert(target.extent.width <= s.options.largest.width && target.extent.height <= s.options.largest.height);
    assert(int(target.extent.width) == plan.views[view].intrinsics.width &&
           int(target.extent.height) == plan.views[view].intrinsics.height);
    s.draw(commandBuffer, plan, view, extent, timer);
    if (s.fills(plan)) {
      const GpuScope scope(commandBuffer, timer, "fill");
      s.fill->record(commandBuffer, extent, source);
    }
    if (target.depth) {
      const GpuScope scope(commandBuffer, timer, "depth");
      const bool hasDepth = plan.settings.order == DrawOrder::ours && plan.settings.overlay != Overlay::overlap;
      const std::uint32_t steps = hasDepth ? stepsOf(*s.scene, plan, Order::current, view).count : 0;
      s.depth->record(commandBuffer, source, steps, plan.nearDistance, extent, target.extent, *target.depth);
    }
    const GpuScope scope(commandBuffer, timer, "composite");
    s.composite->record(commandBuffer, source, plan, view, extent, s.mixes(plan) ? float(plan.formerWeight) : 0.0f,
                        s.fills(plan), target);
  }
}

void Renderer::recordBuffers(VkCommandBuffer commandBuffer, const FramePlan& plan, std::size_t view,
                             const BufferTargets& targets) const noexcept {
  const State& s = *state_;
  assert(s.buffers && view < plan.views.size() && plan.views.size() <= s.options.views);
  assert(targets.extent.width <= s.options.largest.width && targets.extent.height <= s.options.largest.height);
  s.cells->update(commandBuffer, plan);
  const bool gathers = s.gathers(plan);
  if (gathers) {
    s.gather->update(commandBuffer, plan, view, targets.extent);
    s.gather->vote(commandBuffer, plan, view, targets.extent);
  }
  s.buffers->record(commandBuffer, plan, view, targets, gathers ? &*s.gather : nullptr);
}

Renderer::Counters Renderer::count(const FramePlan& plan) const noexcept {
  const State& s = *state_;
  Counters counters;
  counters.pipelines = s.cells->pipelineCount() + s.composite->pipelineCount();
  counters.workingBytes = s.canvas.allocatedBytes();
  counters.bytes = {.canvases = s.canvas.bytes() + (s.former ? s.former->bytes() : 0) + (s.eyes ? s.eyes->bytes() : 0),
                    .fill = s.fill ? s.fill->bytes() : 0,
                    .colours = s.colours ? s.colours->bytes() : 0,
                    .parameters = s.cells->parameterBytes(),
                    .noise = s.cells->noiseBytes(),
                    .uncertainties = s.uncertainties ? s.uncertainties->bytes() : 0,
                    .hiddenArea = s.hidden ? s.hidden->bytes() : 0,
                    .gather = s.gather ? s.gather->bytes() : 0};
  const auto drawn = [&](std::size_t view) {
    const Intrinsics& k = plan.views[view].intrinsics;
    return s.drawn(plan, {std::uint32_t(k.width), std::uint32_t(k.height)});
  };
  if (s.eyes) counters.workingBytes += s.eyes->allocatedBytes();
  if (s.former) counters.workingBytes += s.former->allocatedBytes();
  if (s.depth) counters.pipelines += s.depth->pipelineCount();
  if (s.uncertainties) counters.workingBytes += s.uncertainties->allocatedBytes();
  if (s.hidden) {
    counters.pipelines += s.hidden->pipelineCount();
    counters.workingBytes += s.hidden->bytes();
  }
  if (s.gather) {
    counters.pipelines += s.gather->pipelineCount();
    counters.workingBytes += s.gather->allocatedBytes();
  }
  if (s.overlays) counters.pipelines += s.overlays->pipelineCount();
  if (s.buffers) counters.pipelines += s.buffers->pipelineCount();
  if (s.fill) {
    counters.pipelines += FillPass::kPipelineCount;
    counters.workingBytes += s.fill->allocatedBytes();
  }
  if (s.colours) {
    counters.pipelines += s.colours->pipelineCount();
    counters.workingBytes += s.colours->imageBytes();
    s.colours->count(plan, drawn(0), counters);
  }
  const auto countHidden = [&](std::uint32_t triangles) {
    counters.draws += triangles > 0;
    counters.triangles += triangles;
  };
  for (std::size_t view = 0; view < plan.views.size(); ++view) {
    if (s.fills(plan)) counters.dispatches += FillPass::dispatchCount(drawn(view));
    if (s.gathers(plan)) {
      ++counters.passes;  // the depths of the candidates
      counters.draws += std::uint32_t(plan.photographs.size());
      counters.triangles += GatherPass::triangleCount(*s.scene, plan);
      counters.dispatches += GatherPass::dispatchCount(plan, drawn(view));
    }
    ++counters.passes;  // the composition, a triangle
    ++counters.draws;
    ++counters.triangles;
    for (const Order order : {Order::current, Order::former}) {
      if (order == Order::former && !s.mixes(plan)) continue;
      if (order == Order::current && view == 1 && s.drawsAtOnce(plan)) continue;  // with the first
      ++counters.passes;
      const bool both = order == Order::current && s.drawsAtOnce(plan);
      if (s.gathers(plan)) {  // a triangle over the canvas
        ++counters.draws;
        ++counters.triangles;
      }
      if (s.hides(plan)) countHidden(s.hidden->triangleCount(view) + (both ? s.hidden->triangleCount(1) : 0));
      const Steps steps = stepsOf(*s.scene, plan, order, view);
      for (const Step& step : steps.all()) {
        if (step.hidden) continue;
        ++counters.draws;
        counters.triangles += step.mesh->indices.count / 3;
      }
    }
  }
  return counters;
}

}  // namespace ibr
