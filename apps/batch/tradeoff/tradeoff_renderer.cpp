// SPDX-License-Identifier: Apache-2.0
#include "batch/tradeoff/tradeoff_renderer.h"

#include <algorithm>
#include <chrono>
#include <tuple>

#include "base/check.h"
#include "batch/files/reencode_textures.h"
#include "shared/draw/scene_renderer.h"

namespace ibr::app {
namespace {

GpuSceneOptions gpuOptionsOf(const TradeoffVariant& variant, const Context& context) {
  GpuSceneOptions options = batchOptions({}, context);
  options.filter = variant.filter;
  if (variant.texture) {
    options.source = encodedAs(*variant.texture);
    options.blocks = BlockTextureMode::keep;
  }
  return options;
}

std::string sceneKey(const TradeoffVariant& variant) {
  return fmt::format("{} {} {}", variant.build, variant.texture ? textureFormatName(*variant.texture) : "stored",
                     int(variant.filter));
}

// Key of the RendererOptions that optionsFor derives from the settings.
std::string rendererKey(const TradeoffVariant& variant) {
  const RendererOptions options = optionsFor(variant.settings, {});
  return fmt::format("{} {} {} {} {} {} {} {} {} {} {} {} {}", int(options.compositions[0]), options.gatherCandidates,
                     options.gatherColours, options.gatherLayers, options.voteScale, variant.views,
                     int(options.orders[0]), int(options.blends[0]), options.dissolve, options.crossFadeOrders,
                     options.fill, int(options.colour), options.maxRenderScale);
}

}  // namespace

TradeoffRenderer::TradeoffRenderer(const std::vector<Scene>& scenes, VkExtent2D largest, const Context& context)
    : scenes_(scenes),
      largest_(largest),
      context_(context),
      device_(Device::create({.device = context.options().device, .log = context.log()})),
      timer_(device_, 32) {
  for (const Scene& scene : scenes) bounds_.push_back(sceneBounds(scene));
}

TradeoffRenderer::PreparedScene& TradeoffRenderer::preparedScene(const TradeoffVariant& variant) {
  const std::string key = sceneKey(variant);
  const auto found = preparedScenes_.find(key);
  if (found != preparedScenes_.end()) return found->second;
  return preparedScenes_
      .emplace(key, PreparedScene{GpuScene(device_, scene(variant), gpuOptionsOf(variant, context_)), {}})
      .first->second;
}

Renderer& TradeoffRenderer::rendererOf(const TradeoffVariant& variant) {
  PreparedScene& prepared = preparedScene(variant);
  const std::string key = rendererKey(variant);
  const auto found = prepared.renderers.find(key);
  if (found != prepared.renderers.end()) return found->second;
  RendererOptions options = optionsFor(variant.settings, largest_);
  options.maxViews = std::uint32_t(variant.views);
  return prepared.renderers.emplace(key, Renderer(device_, prepared.gpuScene, options)).first->second;
}

void TradeoffRenderer::prepare(const TradeoffVariant& variant) {
  rendererOf(variant);
}

Offscreen& TradeoffRenderer::offscreenOf(const Camera& view, std::size_t eye) {
  const Intrinsics& k = view.intrinsics;
  const VkExtent2D extent{std::uint32_t(k.width), std::uint32_t(k.height)};
  return offscreens_.try_emplace({k.width, k.height, int(eye)}, device_, extent).first->second;
}

std::vector<Target> TradeoffRenderer::targetsOf(const FramePlan& plan) {
  std::vector<Target> targets;
  for (std::size_t eye = 0; eye < plan.views.size(); ++eye)
    targets.push_back(offscreenOf(plan.views[eye], eye).target());
  return targets;
}

// The first of two eyes is at the view itself, since the truth was photographed there.
FrameInput TradeoffRenderer::inputOf(const TradeoffVariant& variant, const Camera& view) const {
  Camera middle = view;
  middle.pose.position += view.pose.rotation * glm::dvec3(0.5 * kEyeDistance, 0, 0);
  FrameInput input{variant.views == 1 ? std::vector{view} : eyesAround(middle, kEyeDistance), variant.settings};
  input.settings.alpha = AlphaContent::tier;
  return input;
}

FramePlan TradeoffRenderer::plan(const TradeoffVariant& variant, const Camera& view, double dtSeconds,
                                 const PlanState& state) const {
  FrameInput input = inputOf(variant, view);
  input.dtSeconds = dtSeconds;
  return planFrame(scene(variant), bounds_[variant.build], input, state);
}

Image8 TradeoffRenderer::picture(const TradeoffVariant& variant, const FramePlan& plan) {
  const Renderer& renderer = rendererOf(variant);
  const std::vector<Target> targets = targetsOf(plan);
  return offscreenOf(plan.views[0], 0).render([&](VkCommandBuffer commands) {
    renderer.record(commands, plan, targets);
  });
}

Image8 TradeoffRenderer::picture(const TradeoffVariant& variant, const Camera& view) {
  return picture(variant, plan(variant, view));
}

TradeoffTimes TradeoffRenderer::time(const TradeoffVariant& variant, const Camera& view) {
  const Renderer& renderer = rendererOf(variant);
  TradeoffTimes times;
  const auto begin = std::chrono::steady_clock::now();
  const FramePlan planned = plan(variant, view);
  times.plan = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  for (const WeightedPlan& weighted : weightedPlans(scene(variant), bounds_[variant.build], inputOf(variant, view))) {
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

EyeAgreement TradeoffRenderer::eyes(const TradeoffVariant& variant, const Camera& view) const {
  const FrameInput input = inputOf(variant, view);
  std::vector<View> views;
  for (const Camera& eye : input.views) views.push_back({.name = "eye", .camera = eye});
  RendererOptions options = optionsFor(variant.settings, {});
  options.maxViews = std::uint32_t(variant.views);
  options.bufferScene = &scene(variant);
  SceneRenderer renderer(scene(variant), views, gpuOptionsOf(variant, context_), options, context_);
  PlanState state;
  const std::vector<SceneRenderer::Picture> pictures = renderer.render(input.views, input.settings, state);
  return eyeAgreement(pictures[0], input.views[0], pictures[1], input.views[1]);
}

Renderer::Counters TradeoffRenderer::count(const TradeoffVariant& variant, const FramePlan& plan) {
  return rendererOf(variant).count(plan);
}

GpuScene::Memory TradeoffRenderer::memory(const TradeoffVariant& variant) {
  return preparedScene(variant).gpuScene.memory();
}

MemoryDemand TradeoffRenderer::predicted(const TradeoffVariant& variant) const {
  std::vector<TextureFormat> formats = textureFormats(scene(variant));
  const bool software = device_.kind() == DeviceKind::software;
  for (std::size_t n = 0; n < formats.size(); ++n) {
    if (variant.texture)
      formats[n] = *variant.texture == TextureFormat::bc1 && !scene(variant).nodes[n].maskFile.empty()
                       ? TextureFormat::bc7
                       : *variant.texture;
    else if (software || !device_.supportsBlockCompression())
      formats[n] = TextureFormat::rgba8;  // as BlockTextureMode::automatic does
  }
  return memoryDemand(scene(variant), formats, depthTextureBytes(scene(variant)));
}

bool hasPlainTextures(const Scene& scene) {
  return std::ranges::all_of(textureFormats(scene), [](TextureFormat f) { return f == TextureFormat::rgba8; });
}

}  // namespace ibr::app
