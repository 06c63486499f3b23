// SPDX-License-Identifier: Apache-2.0
#include "batch/tradeoff/tradeoff_stage.h"

#include <algorithm>
#include <chrono>
#include <tuple>

#include "base/check.h"
#include "batch/files/encoded_as.h"
#include "shared/draw/scene_renderer.h"

namespace ibr::app {
namespace {

GpuSceneOptions gpuOptionsOf(const TradeoffWay& way, const Context& context) {
  GpuSceneOptions options = withLog({}, context);
  options.filter = way.filter;
  if (way.texture) {
    options.source = encodedAs(*way.texture);
    options.blocks = BlockTextures::keep;
  }
  return options;
}

std::string placeKey(const TradeoffWay& way) {
  return fmt::format("{} {} {}", way.build, way.texture ? textureFormatName(*way.texture) : "stored", int(way.filter));
}

// Key of the RendererOptions that optionsFor derives from the settings.
std::string rendererKey(const TradeoffWay& way) {
  const RendererOptions options = optionsFor(way.settings, {});
  return fmt::format("{} {} {} {} {} {} {} {} {} {} {} {} {}", int(options.compositions[0]), options.gatherCandidates,
                     options.gatherColours, options.gatherLayers, options.voteScale, way.views, int(options.orders[0]),
                     int(options.blends[0]), options.dissolve, options.switchMixing, options.fill, int(options.colour),
                     options.maxRenderScale);
}

}  // namespace

TradeoffStage::TradeoffStage(const std::vector<Scene>& scenes, VkExtent2D largest, const Context& context)
    : scenes_(scenes),
      largest_(largest),
      context_(context),
      device_(Device::create({.device = context.options().device, .log = context.log()})),
      timer_(device_, 32) {
  for (const Scene& scene : scenes) bounds_.push_back(sceneBounds(scene));
}

TradeoffStage::PreparedScene& TradeoffStage::placeOf(const TradeoffWay& way) {
  const std::string key = placeKey(way);
  const auto found = places_.find(key);
  if (found != places_.end()) return found->second;
  return places_.emplace(key, PreparedScene{GpuScene(device_, scene(way), gpuOptionsOf(way, context_)), {}})
      .first->second;
}

Renderer& TradeoffStage::rendererOf(const TradeoffWay& way) {
  PreparedScene& place = placeOf(way);
  const std::string key = rendererKey(way);
  const auto found = place.renderers.find(key);
  if (found != place.renderers.end()) return found->second;
  RendererOptions options = optionsFor(way.settings, largest_);
  options.maxViews = std::uint32_t(way.views);
  return place.renderers.emplace(key, Renderer(device_, place.gpuScene, options)).first->second;
}

void TradeoffStage::prepare(const TradeoffWay& way) {
  rendererOf(way);
}

Offscreen& TradeoffStage::offscreenOf(const Camera& view, std::size_t eye) {
  const Intrinsics& k = view.intrinsics;
  const VkExtent2D extent{std::uint32_t(k.width), std::uint32_t(k.height)};
  return offscreens_.try_emplace({k.width, k.height, int(eye)}, device_, extent).first->second;
}

std::vector<Target> TradeoffStage::targetsOf(const FramePlan& plan) {
  std::vector<Target> targets;
  for (std::size_t eye = 0; eye < plan.views.size(); ++eye)
    targets.push_back(offscreenOf(plan.views[eye], eye).target());
  return targets;
}

// The first of two eyes is at the view itself, since the truth was photographed there.
FrameInput TradeoffStage::inputOf(const TradeoffWay& way, const Camera& view) const {
  Camera middle = view;
  middle.pose.position += view.pose.rotation * glm::dvec3(0.5 * kEyeDistance, 0, 0);
  FrameInput input{way.views == 1 ? std::vector{view} : eyesAround(middle, kEyeDistance), way.settings};
  input.settings.alpha = AlphaContent::tier;
  return input;
}

FramePlan TradeoffStage::plan(const TradeoffWay& way, const Camera& view, double dtSeconds,
                              const PlanState& state) const {
  FrameInput input = inputOf(way, view);
  input.dtSeconds = dtSeconds;
  return planFrame(scene(way), bounds_[way.build], input, state);
}

Image8 TradeoffStage::picture(const TradeoffWay& way, const FramePlan& plan) {
  const Renderer& renderer = rendererOf(way);
  const std::vector<Target> targets = targetsOf(plan);
  return offscreenOf(plan.views[0], 0).render([&](VkCommandBuffer commands) {
    renderer.record(commands, plan, targets);
  });
}

Image8 TradeoffStage::picture(const TradeoffWay& way, const Camera& view) {
  return picture(way, plan(way, view));
}

TradeoffTimes TradeoffStage::time(const TradeoffWay& way, const Camera& view) {
  const Renderer& renderer = rendererOf(way);
  TradeoffTimes times;
  const auto begin = std::chrono::steady_clock::now();
  const FramePlan planned = plan(way, view);
  times.plan = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  for (const WeightedPlan& weighted : weightedPlans(scene(way), bounds_[way.build], inputOf(way, view))) {
    const std::vector<Target> targets = targetsOf(weighted.plan);
    offscreenOf(view, 0).render([&](VkCommandBuffer commands) {
      timer_.reset(commands);
      const GpuScope scope(commands, &timer_, "frame");
      renderer.record(commands, weighted.plan, targets, &timer_);
    });
    const std::vector<ScopeTime> scopes = timer_.read();
    check(!scopes.empty(), ErrorCode::unsupported, "{}: the queue has no timestamps", device_.name());
    for (const ScopeTime& scope : scopes)
      if (scope.depth <= 1)
        (scope.depth == 0 ? times.device : times.passes[scope.name]) += weighted.weight * scope.milliseconds;
  }
  return times;
}

EyeAgreement TradeoffStage::eyes(const TradeoffWay& way, const Camera& view) const {
  const FrameInput input = inputOf(way, view);
  std::vector<View> views;
  for (const Camera& eye : input.views) views.push_back({.name = "eye", .camera = eye});
  RendererOptions options = optionsFor(way.settings, {});
  options.maxViews = std::uint32_t(way.views);
  options.bufferScene = &scene(way);
  SceneRenderer renderer(scene(way), views, gpuOptionsOf(way, context_), options, context_);
  PlanState state;
  const std::vector<SceneRenderer::Picture> pictures = renderer.render(input.views, input.settings, state);
  return eyeAgreement(pictures[0], input.views[0], pictures[1], input.views[1]);
}

Renderer::Counters TradeoffStage::count(const TradeoffWay& way, const FramePlan& plan) {
  return rendererOf(way).count(plan);
}

GpuScene::Memory TradeoffStage::memory(const TradeoffWay& way) {
  return placeOf(way).gpuScene.memory();
}

MemoryDemand TradeoffStage::predicted(const TradeoffWay& way) const {
  std::vector<TextureFormat> formats = textureFormats(scene(way));
  const bool software = device_.kind() == DeviceKind::software;
  for (std::size_t n = 0; n < formats.size(); ++n) {
    if (way.texture)
      formats[n] = *way.texture == TextureFormat::bc1 && !scene(way).nodes[n].maskFile.empty() ? TextureFormat::bc7
                                                                                               : *way.texture;
    else if (software || !device_.supportsBlockCompression())
      formats[n] = TextureFormat::rgba8;  // as BlockTextures::automatic does
  }
  return memoryDemand(scene(way), formats, depthTextureBytes(scene(way)));
}

bool hasPlainTextures(const Scene& scene) {
  return std::ranges::all_of(textureFormats(scene), [](TextureFormat f) { return f == TextureFormat::rgba8; });
}

}  // namespace ibr::app
