// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <optional>
#include <utility>

#include "base/stopwatch.h"
#include "base/vulkan/submit.h"
#include "ibr/gpu_scene.h"
#include "ibr/offscreen.h"
#include "shared/draw/graph_lines.h"
#include "shared/report/statistics.h"
#include "viewer/open/item_on_device.h"
#include "viewer/open/trust_probe.h"

namespace ibr::app {
namespace {

// Returns the largest render scale that a renderer draws; without a maximum, images have the target's size.
double largestScale(const RendererOptions& options) {
  return options.maxRenderScale > 0 ? options.maxRenderScale : 1;
}

// Returns true if a renderer made with `has` can draw everything that `needs` asks for.
bool canDraw(const RendererOptions& has, const RendererOptions& needs) {
  const auto within = [](const auto& few, const auto& many) {
    return std::ranges::all_of(few, [&](auto one) { return std::ranges::find(many, one) != many.end(); });
  };
  return has.maxExtent.width >= needs.maxExtent.width && has.maxExtent.height >= needs.maxExtent.height &&
         has.crossFadeOrders >= needs.crossFadeOrders && has.fill >= needs.fill && has.colour >= needs.colour &&
         within(needs.overlays, has.overlays) && has.floor >= needs.floor && has.dissolve >= needs.dissolve &&
         has.maxRenderScale >= needs.maxRenderScale && largestScale(has) >= largestScale(needs) &&
         within(needs.formats, has.formats) && within(needs.orders, has.orders) && within(needs.blends, has.blends) &&
         within(needs.compositions, has.compositions) && has.gatherCandidates >= needs.gatherCandidates &&
         has.gatherColours == needs.gatherColours && has.gatherLayers == needs.gatherLayers &&
         has.voteScale >= needs.voteScale;
}

class SceneOnDevice final : public ItemOnDevice {
 public:
  SceneOnDevice(Device& device, std::shared_ptr<OpenItem> item, UploadedScene uploaded)
      : device_(device), owned_(std::move(item)), uploaded_(std::move(uploaded)) {}

  void record(const FrameContext& context, const Target& target, ScopeTimer* timer) override {
    const Camera view = cameraOf(item_, target.extent);
    const RenderSettings& s = item_.settings;
    const bool aligns = s.alignCells && item_.canAlign();
    const bool sameAlignment = input_.settings.alignCells == aligns;
    input_.settings.alignCells = s.alignCells;
    const bool sameSettings = s == input_.settings && sameAlignment;
    const bool same = sameSettings && sameView(view, input_.views[0]);
    if (!sameSettings) input_.settings = s;
    input_.settings.alignCells = aligns;
    input_.views[0] = view;
    input_.dtSeconds = context.seconds;
    planFrame(*item_.scene, bounds_, input_, plan_.next, plan_);
    prepare(target, sameSettings);
    streamed_ = gpuScene_.stream(context.commands, plan_, context.frame, context.completed);
    renderer_->record(context.commands, plan_, std::span(&target, 1), timer);
    if (item_.showGraph) {
      const GpuScope scope(context.commands, timer, "graph");
      recordGraph(context.commands, graph(), plan_, std::span(&target, 1));
    }
    // The colour mapping may fade for longer than the draw order's cross-fade.
    quiet_ = same ? quiet_ + context.seconds : 0;
    const double fades = std::max(s.switchSeconds, s.colourMapping == ColourMapping::off ? 0.0 : s.colourFadeSeconds);
    const std::optional<glm::dvec3>& exposure = plan_.next.exposure;
    const bool adapts = exposure && lastExposure_ && glm::distance(*exposure, *lastExposure_) > 1e-4;
    lastExposure_ = exposure;
    needsRedraw_ = streamed_.waiting > 0 || quiet_ < fades + 0.1 || adapts || aligns != s.alignCells;
  }

  bool needsRedraw() const override { return needsRedraw_; }

  Image8 picture(VkExtent2D extent, std::uint64_t& frame) override {
    const FramePlan plan = planFrame(*item_.scene, bounds_, {{cameraOf(item_, extent)}, item_.settings, 0}, {});
    Offscreen offscreen(device_, extent);
    streamAll(device_, gpuScene_, plan, frame);
    const Renderer renderer(device_, gpuScene_, optionsNeeded(item_.settings, extent));
    return offscreen.render([&](VkCommandBuffer commands) {
      const Target target = offscreen.target();
      renderer.record(commands, plan, target);
      if (item_.showGraph) recordGraph(commands, graph(), plan, std::span(&target, 1));
    });
  }

  TimedImage timed(const Camera& view, const RenderSettings& settings, std::uint64_t& frame) override {
    constexpr int kFrames = 5;  // after the first frame, which is slow
    const FramePlan plan = planFrame(*item_.scene, bounds_, {{view}, settings, 0}, {});
    const VkExtent2D extent{std::uint32_t(view.intrinsics.width), std::uint32_t(view.intrinsics.height)};
    Offscreen offscreen(device_, extent);
    streamAll(device_, gpuScene_, plan, frame);
    const Renderer renderer(device_, gpuScene_, optionsNeeded(settings, extent));
    ScopeTimer timer(device_, 1);
    TimedImage picture{};
    std::vector<double> times;
    for (int i = 0; i <= kFrames; ++i) {
      const Stopwatch watch;
      picture.image = offscreen.render([&](VkCommandBuffer commands) {
        timer.reset(commands);
        const GpuScope scope(commands, &timer, "frame");
        renderer.record(commands, plan, offscreen.target());
      });
      const std::vector<ScopeTime> scopes = timer.read();
      if (i > 0) times.push_back(scopes.empty() ? 1e3 * watch.seconds() : scopes[0].milliseconds);
    }
    picture.milliseconds = quantile(times, 0.5);
    return picture;
  }

  std::optional<glm::dvec3> pointAt(VkExtent2D extent, glm::dvec2 pixel) override {
    const Camera view = cameraOf(item_, extent);
    const auto depth = probe().depthAt(view, item_.settings, pixel);
    return depth ? pickedPoint(view, pixel, *depth) : std::nullopt;
  }

  std::optional<Trust> trust(VkExtent2D extent) override {
    return probe().trust(cameraOf(item_, extent), item_.settings);
  }

  void rebuildPipelines() override {
    waitIdle(device_);
    graph_.reset();
    probe_.reset();
    if (!renderer_) return;
    Renderer fresh(device_, gpuScene_, options_);
    *renderer_ = std::move(fresh);
  }

  const FramePlan* plan() const override { return &plan_; }

  std::vector<MemoryClass> memory() const override {
    const GpuScene::Memory m = gpuScene_.memory();
    return {{"photographs", m.textures, true},
            {"depths", m.depth, true},
            {"vertices", m.positions, true},
            {"triangles", m.indices, true},
            {"working images", renderer_ ? renderer_->count(plan_).workingBytes : 0, false}};
  }

  std::optional<GpuScene::StreamStatus> streamed() const override { return streamed_; }

 private:
  RendererOptions optionsNeeded(const RenderSettings& settings, VkExtent2D extent,
                                VkFormat format = VK_FORMAT_R8G8B8A8_UNORM) const {
    RendererOptions options = optionsFor(settings, extent, format);
    options.uncertaintyScene = &*item_.scene;
    return options;
  }

  // `sameSettings`: as in the previous frame.
  void prepare(const Target& target, bool sameSettings) {
    const bool sameTarget = target.extent.width == prepared_.extent.width &&
                            target.extent.height == prepared_.extent.height && target.format == prepared_.format;
    if (renderer_ && sameSettings && sameTarget) return;
    prepared_ = target;
    const RendererOptions needed = optionsNeeded(item_.settings, target.extent, target.format);
    if (renderer_ && canDraw(options_, needed)) return;
    waitIdle(device_);
    renderer_.reset();  // release first, so that two renderers never hold memory at once
    options_ = needed;
    renderer_.emplace(device_, gpuScene_, options_);
  }

  GraphOverlay& graph() {
    if (!graph_) graph_ = graphLines(device_, *item_.scene, VK_FORMAT_R8G8B8A8_UNORM);  // of all intermediate images
    return *graph_;
  }

  TrustProbe& probe() {
    if (!probe_) probe_.emplace(device_, *item_.scene, bounds_, gpuScene_);
    return *probe_;
  }

  Device& device_;
  std::shared_ptr<OpenItem> owned_;  // declared before the scene on the device, whose threads read it
  OpenItem& item_ = *owned_;
  const SceneBounds& bounds_ = item_.sceneBounds;
  UploadedScene uploaded_;
  GpuScene& gpuScene_ = uploaded_.scene;
  RendererOptions options_;
  std::optional<Renderer> renderer_;
  std::optional<GraphOverlay> graph_;
  std::optional<TrustProbe> probe_;
  FrameInput input_{.views = std::vector<Camera>(1)};  // of the last frame
  FramePlan plan_;
  Target prepared_{};  // that renderer_ was last checked for
  GpuScene::StreamStatus streamed_;
  std::optional<glm::dvec3> lastExposure_;  // of the adapting exposure, logarithms
  double quiet_ = 0;
  bool needsRedraw_ = true;
};

}  // namespace

UploadedScene uploadScene(Device device, const Scene& scene, const GpuSceneOptions& options) {
  auto own = std::make_unique<Device>(std::move(device));
  GpuScene uploaded(*own, scene, options);
  return {std::move(own), std::move(uploaded)};
}

std::unique_ptr<ItemOnDevice> sceneOnDevice(Device& device, std::shared_ptr<OpenItem> item, UploadedScene uploaded) {
  return std::make_unique<SceneOnDevice>(device, std::move(item), std::move(uploaded));
}

}  // namespace ibr::app
