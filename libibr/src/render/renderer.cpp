// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <optional>
#include <string>

#include "base/check.h"
#include "base/vulkan/target_format.h"
#include "gpu/draw/canvas.h"
#include "gpu/draw/multiview.h"
#include "gpu/transfer/upload.h"
#include "ibr/renderer.h"
#include "ibr/scope_timer.h"
#include "render/clear_targets.h"
#include "render/exceeded_option.h"
#include "render/passes/buffer_pass.h"
#include "render/passes/cell_pass.h"
#include "render/passes/colour_map_pass.h"
#include "render/passes/colour_tables.h"
#include "render/passes/composite_pass.h"
#include "render/passes/depth_pass.h"
#include "render/passes/draw_list.h"
#include "render/passes/fill_pass.h"
#include "render/passes/gather_pass.h"
#include "render/passes/hidden_area_pass.h"
#include "render/passes/overlay_pass.h"
#include "render/passes/uncertainties.h"
#include "render/plan/colour_plan.h"
#include "render/resident/gpu_scene_state.h"

namespace ibr {
namespace {

// Returns true if no field is exceeded; else names the field in `why`.
bool isWithin(const char* exceeded, std::string* why) {
  if (exceeded && why) *why = std::string("RendererOptions::") + exceeded;
  return !exceeded;
}

}  // namespace

struct Renderer::State {
  State(Device& device, const GpuScene& gpuScene, const RendererOptions& o)
      : scene(&stateOf(gpuScene)),
        options(o),
        requirements(withOptions(scene->requirements, o)),
        canvas(device, scaled(o.maxExtent, canvasScale(o)),
               ColourMapPass::canvasUse(requirements.colourSequence ? ColourSupport::all : ColourSupport::off)) {
    const Requirements& needed = requirements;
    Uploader uploader(device, o.uploads, kSmallStagingBytes);
    checkHiddenArea(o.hiddenArea);
    if (needed.crossFadeOrders) previous.emplace(device, canvas.largest());
    if (needed.multiview && (o.uploads ? multiviewIsKnownToWork(device) : multiviewWorks(device)))
      eyes.emplace(device, canvas.largest(), 0, 2);
    if (needed.fill) {
      std::vector<VkImageView> sources;
      for (const CanvasSource& source : sourcesOf(canvas, eyesOrNull())) sources.push_back(source.colour);
      fill.emplace(device, canvas.largest(), sources);
    }
    if (needed.colourTables) tables.emplace(device, std::min(needed.cells, kMaxCellCount), uploader);
    cells.emplace(device, gpuScene, canvas.renderPass(), o, needed, uploader,
                  tables ? tables->tables() : VK_NULL_HANDLE, eyes ? eyes->renderPass() : VK_NULL_HANDLE);
    if (needed.hiddenArea)
      hidden.emplace(device, o.hiddenArea, canvas.renderPass(), eyes ? eyes->renderPass() : VK_NULL_HANDLE, uploader);
    if (needed.gather) gather.emplace(device, gpuScene, canvas.renderPass(), canvas.largest(), o, needed);
    if (tables) colours.emplace(device, *tables, *cells, canvas, o);
    composite.emplace(device, canvas, eyesOrNull(), previous ? &*previous : nullptr, fill ? &*fill : nullptr, o,
                      needed.hiddenArea);
    if (needed.depth) depth.emplace(device, canvas, eyesOrNull(), needed.hiddenArea);
    if (const Scene* known = uncertaintiesFor(o)) uncertainties.emplace(device, *known, *scene, uploader);
    const Uncertainties* known = uncertainties ? &*uncertainties : nullptr;
    if (!needed.overlays.empty()) overlays.emplace(device, *cells, canvas.renderPass(), o, needed, known);
    if (needed.buffers) buffers.emplace(device, *cells, *known, canvas, needed);
    // CompositePass binds all images in every frame, even images that the frame does not draw. Every image needs the
    // layout of its binding from the start.
    uploader.commands([this](VkCommandBuffer commands) {
      const std::array<const Canvas*, 3> images{&canvas, previous ? &*previous : nullptr, eyesOrNull()};
      for (const Canvas* image : images) {
        if (!image) continue;
        image->begin(commands, image->largest(), {0, 0, 0, 0});
        image->end(commands);
      }
      if (fill) fill->record(commands, canvas.largest(), kFromCanvas);
    });
    uploader.flush();
  }

  const Canvas* eyesOrNull() const { return eyes ? &*eyes : nullptr; }

  bool has(Overlay overlay) const {
    return std::ranges::find(requirements.overlays, overlay) != requirements.overlays.end();
  }
  // Returns the scene that the uncertainties of ρ are read from; null: no overlay or buffer shows them.
  const Scene* uncertaintiesFor(const RendererOptions& o) const {
    if (!has(Overlay::confidence)) return o.bufferScene;
    check(o.uncertaintyScene, ErrorCode::invalidInput,
          "renderer: Overlay::confidence needs RendererOptions::uncertaintyScene");
    return o.uncertaintyScene;
  }

  // Features of a plan that this renderer uses.
  bool crossFades(const FramePlan& plan) const { return previous && plan.previousWeight > 0; }
  bool drawsBothEyesAtOnce(const FramePlan& plan) const {
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
    return hidden && plan.settings.skipHiddenArea && !cells->isPainters(plan.settings);
  }
  bool fills(const FramePlan& plan) const {
    return fill && plan.settings.maxTier >= kTierFilled &&
           (plan.settings.overlay == Overlay::none || plan.settings.overlay == Overlay::wireframe);
  }

  // Fills the canvas, or with the first view the canvas of both eyes, and the canvas of the previous order.
  void draw(VkCommandBuffer commands, const PlanDraws& draws, std::size_t view, VkExtent2D extent,
            ScopeTimer* timer) const noexcept;
  void drawCells(VkCommandBuffer commands, const PlanDraws& draws, Order order, std::size_t view,
                 VkExtent2D extent) const noexcept;

  // Extent of the view's image in the canvas.
  VkExtent2D drawn(const FramePlan& plan, VkExtent2D target) const {
    return scaled(target, options.maxRenderScale > 0 ? plan.settings.renderScale : 0);
  }
  // Buffers are drawn at the size of their targets and use the canvas's depth image, so the canvas must be as large.
  static double canvasScale(const RendererOptions& o) {
    return o.bufferScene && o.maxRenderScale > 0 ? std::max(1.0, o.maxRenderScale) : o.maxRenderScale;
  }
  static VkExtent2D scaled(VkExtent2D extent, double scale) {  // 0: unscaled
    if (scale == 0) return extent;
    const auto side = [&](std::uint32_t n) { return std::max(1u, std::uint32_t(std::lround(n * scale))); };
    return {side(extent.width), side(extent.height)};
  }

  const GpuScene::State* scene;
  RendererOptions options;
  Requirements requirements;
  Canvas canvas;
  std::optional<Canvas> previous, eyes;  // eyes: both views in one render pass
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

bool Renderer::probeMultiview(const Device& device) {
  return multiviewWorks(device);
}

bool Renderer::supports(TargetFormat format, std::string* why) {
  const char* fault = targetFormatFault(format);
  if (fault && why) *why = fault;
  return !fault;
}

bool Renderer::supports(const FramePlan& plan, std::string* why) const {
  return isWithin(exceededOption(plan, state_->options), why);
}

bool Renderer::supports(const Target& target, std::string* why) const {
  return isWithin(exceededOption(target, state_->options), why);
}

void Renderer::State::draw(VkCommandBuffer commands, const PlanDraws& draws, std::size_t view, VkExtent2D extent,
                           ScopeTimer* timer) const noexcept {
  const FramePlan& plan = draws.plan;
  if (adapts(plan) && (view == 0 || !eyesShare(plan))) {
    const GpuScope scope(commands, timer, "colour tables");
    colours->makeTables(commands, draws, view, extent);
  }
  if (gathers(plan)) {
    const GpuScope scope(commands, timer, "vote");
    gather->update(commands, plan, view, extent);
    gather->vote(commands, plan, view, extent);
  }
  const bool atOnce = drawsBothEyesAtOnce(plan);
  if (!atOnce || view == 0) {
    const GpuScope scope(commands, timer, "canvas");
    if (atOnce) {
      eyes->begin(commands, extent, {0, 0, 0, 0});
      if (hides(plan)) hidden->drawEyes(commands, plan, extent);
      cells->drawEyes(commands, draws, extent);
      eyes->end(commands);
    } else if (isSequence(plan) && view == 0) {
      colours->drawSequence(commands, draws, extent);
    } else {
      drawCells(commands, draws, Order::current, view, extent);
    }
  }
  if (!crossFades(plan)) return;
  const GpuScope scope(commands, timer, "previous canvas");
  drawCells(commands, draws, Order::previous, view, extent);
}

void Renderer::State::drawCells(VkCommandBuffer commands, const PlanDraws& draws, Order order, std::size_t view,
                                VkExtent2D extent) const noexcept {
  const FramePlan& plan = draws.plan;
  const Canvas& into = order == Order::current ? canvas : *previous;
  into.begin(commands, extent, {0, 0, 0, 0});
  if (hides(plan)) hidden->draw(commands, plan, view, extent);
  if (plan.settings.overlay == Overlay::none)
    cells->draw(commands, draws, order, view, extent);
  else
    overlays->draw(commands, draws, order, view, extent);
  if (gathers(plan)) {
    const std::uint32_t items = draws.list(order, view).count;
    if (plan.settings.overlay == Overlay::none)
      gather->draw(commands, plan, view, extent, items);
    else
      gather->drawOverlay(commands, plan, view, extent, items);
  }
  into.end(commands);
}

void Renderer::record(VkCommandBuffer commandBuffer, const FramePlan& plan, std::span<const Target> targets,
                      ScopeTimer* timer) const noexcept {
  const State& s = *state_;
  const bool areTargetsDeclared =
      std::ranges::none_of(targets, [&](const Target& target) { return !supports(target); });
  if (!supports(plan) || !areTargetsDeclared) {
    for (const Target& target : targets) clearTarget(commandBuffer, target, plan.settings.background);
    return;
  }
  assert(targets.size() == plan.views.size());
  const PlanDraws draws(*s.scene, plan);
  s.cells->update(commandBuffer, draws);
  const bool atOnce = s.drawsBothEyesAtOnce(plan);
  for (std::size_t view = 0; view < targets.size(); ++view) {
    const Target& target = targets[view];
    const VkExtent2D extent = s.drawn(plan, target.extent);
    const std::size_t source = atOnce ? kFromEyes + view : kFromCanvas;
    assert(!target.depth || s.depth);
    assert(int(target.extent.width) == plan.views[view].intrinsics.width &&
           int(target.extent.height) == plan.views[view].intrinsics.height);
    s.draw(commandBuffer, draws, view, extent, timer);
    if (s.fills(plan)) {
      const GpuScope scope(commandBuffer, timer, "fill");
      s.fill->record(commandBuffer, extent, source);
    }
    if (target.depth) {
      const GpuScope scope(commandBuffer, timer, "depth");
      const bool hasDepth = plan.settings.order == DrawOrder::ours && plan.settings.overlay != Overlay::overlap;
      const std::uint32_t items = hasDepth ? draws.list(Order::current, view).count : 0;
      s.depth->record(commandBuffer, source, items, plan.nearDistance, extent, target.extent, *target.depth);
    }
    const GpuScope scope(commandBuffer, timer, "composite");
    s.composite->record(commandBuffer, source, plan, view, extent,
                        s.crossFades(plan) ? float(plan.previousWeight) : 0.0f, s.fills(plan), target);
  }
}

void Renderer::recordBuffers(VkCommandBuffer commandBuffer, const FramePlan& plan, std::size_t view,
                             const BufferTargets& targets) const noexcept {
  const State& s = *state_;
  if (!s.buffers || !supports(plan)) {
    clearTargets(commandBuffer, targets);
    return;
  }
  assert(view < plan.views.size());
  assert(targets.extent.width <= s.options.maxExtent.width && targets.extent.height <= s.options.maxExtent.height);
  const PlanDraws draws(*s.scene, plan);
  s.cells->update(commandBuffer, draws);
  const bool gathers = s.gathers(plan);
  if (gathers) {
    s.gather->update(commandBuffer, plan, view, targets.extent);
    s.gather->vote(commandBuffer, plan, view, targets.extent);
  }
  s.buffers->record(commandBuffer, draws, view, targets, gathers ? &*s.gather : nullptr);
}

Renderer::Counters Renderer::count(const FramePlan& plan) const noexcept {
  const State& s = *state_;
  const PlanDraws draws(*s.scene, plan);
  Counters counters;
  counters.pipelines = s.cells->pipelineCount() + s.composite->pipelineCount();
  counters.workingBytes = s.canvas.allocatedBytes();
  counters.bytes = {
      .canvases = s.canvas.bytes() + (s.previous ? s.previous->bytes() : 0) + (s.eyes ? s.eyes->bytes() : 0),
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
  if (s.previous) counters.workingBytes += s.previous->allocatedBytes();
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
    s.colours->count(draws, drawn(0), counters);
  }
  const auto countHidden = [&](std::uint32_t triangles) {
    counters.draws += triangles > 0;
    counters.triangles += triangles;
  };
  for (std::size_t view = 0; view < plan.views.size(); ++view) {
    if (s.fills(plan)) counters.dispatches += FillPass::dispatchCount(drawn(view));
    if (s.gathers(plan)) {
      ++counters.passes;  // depths of the candidates
      counters.draws += std::uint32_t(plan.photographs.size());
      counters.triangles += GatherPass::triangleCount(*s.scene, plan);
      counters.dispatches += GatherPass::dispatchCount(plan, drawn(view));
    }
    ++counters.passes;  // the composition draws one triangle
    ++counters.draws;
    ++counters.triangles;
    for (const Order order : {Order::current, Order::previous}) {
      if (order == Order::previous && !s.crossFades(plan)) continue;
      if (order == Order::current && view == 1 && s.drawsBothEyesAtOnce(plan)) continue;  // drawn together with view 0
      ++counters.passes;
      const bool both = order == Order::current && s.drawsBothEyesAtOnce(plan);
      if (s.gathers(plan)) {  // one triangle over the canvas
        ++counters.draws;
        ++counters.triangles;
      }
      if (s.hides(plan)) countHidden(s.hidden->triangleCount(view) + (both ? s.hidden->triangleCount(1) : 0));
      const DrawList& list = draws.list(order, view);
      for (const DrawItem& item : list.all()) {
        if (item.hidden) continue;
        ++counters.draws;
        counters.triangles += item.mesh->place.indices.count / 3;
      }
    }
  }
  return counters;
}

}  // namespace ibr
