// SPDX-License-Identifier: Apache-2.0
#include "viewer/open/trust_probe.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "shared/report/statistics.h"

namespace ibr::app {
namespace {

constexpr int kSide = 64;  // px, longer side of the image that is judged

RendererOptions optionsFor(const Scene& scene) {
  RendererOptions options{.maxExtent = {kSide, kSide}};
  options.crossFadeOrders = options.fill = options.dissolve = false;
  options.colour = ColourSupport::off;
  options.formats = {VK_FORMAT_R8G8B8A8_UNORM};
  options.orders = {DrawOrder::ours};
  options.blends = {BlendMode::blend};
  options.compositions = {Composition::cells, Composition::hybrid, Composition::gathered};
  options.gatherCandidates = kMaxGatherCandidates;
  options.voteScale = 1;
  options.bufferScene = &scene;
  return options;
}

// Returns the camera of a single pixel of the image.
Camera pixelOf(Camera view, glm::dvec2 pixel) {
  Intrinsics& k = view.intrinsics;
  k.cx -= pixel.x - 0.5;
  k.cy -= pixel.y - 0.5;
  k.width = k.height = 1;
  return view;
}

Camera small(Camera view) {
  const Intrinsics& k = view.intrinsics;
  const double scale = double(kSide) / std::max(k.width, k.height);
  const auto side = [&](int pixels) { return std::max(1, int(std::lround(scale * pixels))); };
  view.intrinsics = resized(k, side(k.width), side(k.height));
  return view;
}

}  // namespace

TrustProbe::TrustProbe(Device& device, const Scene& scene, const SceneBounds& bounds, const GpuScene& gpuScene)
    : scene_(scene), bounds_(bounds), device_(device), renderer_(device, gpuScene, optionsFor(scene)) {}

FramePlan TrustProbe::planOf(const Camera& view, RenderSettings settings) const {
  settings.order = DrawOrder::ours;
  settings.blend = BlendMode::blend;
  settings.colourMapping = ColourMapping::off;
  settings.switchSeconds = settings.fadeShare = 0;
  settings.renderScale = settings.voteScale = 1;
  settings.gatherColours = RendererOptions{}.gatherColours;
  settings.gatherLayers = RendererOptions{}.gatherLayers;
  settings.floor.reset();
  settings.overlay = Overlay::none;
  return planFrame(scene_, bounds_, {{view}, settings, 0});
}

FrameBuffers TrustProbe::renderBuffers(const FramePlan& plan) {
  const Intrinsics& k = plan.views[0].intrinsics;
  OffscreenBuffers buffers(device_, {std::uint32_t(k.width), std::uint32_t(k.height)});
  return buffers.render(
      [&](VkCommandBuffer commands) { renderer_.recordBuffers(commands, plan, 0, buffers.targets()); });
}

Trust TrustProbe::trust(const Camera& view, const RenderSettings& settings) {
  const FramePlan plan = planOf(small(view), settings);
  Trust trust{.extrapolation = std::numeric_limits<double>::infinity()};
  RenderSettings ofCells = settings;
  ofCells.composition = Composition::cells;  // also if the hybrid draws no cells because the gather covers more
  if (const FramePlan nearest = planOf(small(view), ofCells); !nearest.cells.empty())
    trust.extrapolation = nearest.cells[0].extrapolationDistance / bounds_.cells[nearest.cells[0].cell].size;
  const FrameBuffers known = renderBuffers(plan);
  std::vector<double> errors;
  const int width = known.surface.width, height = known.surface.height;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const auto surface = known.surface.pixel(x, y);
      const int tier = surface[1] < 0 ? kTierFilled : int(surface[1]);
      trust.tiers[std::size_t(tier)] += 1.0 / (double(width) * height);
      const double error = double(surface[0]) * double(known.confidence.pixel(x, y)[1]);
      if (std::isfinite(error)) errors.push_back(error);
    }
  trust.depthError = errors.empty() ? std::numeric_limits<double>::infinity() : quantile(errors, 0.5);
  return trust;
}

std::optional<double> TrustProbe::depthAt(const Camera& view, const RenderSettings& settings, glm::dvec2 pixel) {
  const double depth = double(renderBuffers(planOf(pixelOf(view, pixel), settings)).surface.pixel(0, 0)[0]);
  return std::isfinite(depth) ? std::optional(depth) : std::nullopt;
}

}  // namespace ibr::app
