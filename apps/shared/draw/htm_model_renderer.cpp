// SPDX-License-Identifier: Apache-2.0
#include "shared/draw/htm_model_renderer.h"

#include <chrono>
#include <utility>

#include "io/image_file.h"
#include "shared/draw/graph_lines.h"

namespace ibr::app {
namespace {

using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

}  // namespace

HtmImage readHtmPicture(const HtmModel& model, std::size_t camera) {
  const HtmCamera& c = model.cameras[camera];
  HtmImage picture{readImage(model.folder / c.imageFile), {}};
  if (c.visibilityFile.empty()) return picture;
  const Image8 grey = readImage(model.folder / c.visibilityFile);
  picture.visibility = Image8(grey.width, grey.height, 1);
  for (int y = 0; y < grey.height; ++y)
    for (int x = 0; x < grey.width; ++x) picture.visibility.pixel(x, y)[0] = grey.pixel(x, y)[0];
  return picture;
}

HtmModelRenderer::HtmModelRenderer(const HtmModel& model, const Context& context, const HtmImageSource& source)
    : HtmModelRenderer(
          model, std::make_unique<Device>(Device::create({.device = context.options().device, .log = context.log()})),
          nullptr, source) {}

HtmModelRenderer::HtmModelRenderer(const HtmModel& model, Device& device, const HtmImageSource& source)
    : HtmModelRenderer(model, nullptr, &device, source) {}

HtmModelRenderer::HtmModelRenderer(const HtmModel& model, std::unique_ptr<Device> owned, Device* device,
                                   const HtmImageSource& source)
    : model_(&model),
      owned_(std::move(owned)),
      device_(owned_ ? owned_.get() : device),
      gpuModel_(*device_, model, source),  // throws if the model is invalid
      timer_(*device_, 2) {
  bounds_ = htmBounds(model);
}

void HtmModelRenderer::show(const HtmModel& model, const HtmImageSource& source) {
  gpuModel_.replace(model, source);  // throws if the model is invalid
  model_ = &model;
  bounds_ = htmBounds(model);
  if (renderer_) renderer_->setModel(gpuModel_);
}

void HtmModelRenderer::showGraph() {
  graph_ = graphLines(*device_, *model_, VK_FORMAT_R8G8B8A8_UNORM);
}

void HtmModelRenderer::prepare(const Intrinsics& intrinsics) {
  const VkExtent2D extent{std::uint32_t(intrinsics.width), std::uint32_t(intrinsics.height)};
  if (offscreen_ && offscreen_->target().extent.width == extent.width &&
      offscreen_->target().extent.height == extent.height)
    return;
  renderer_.reset();  // freed first, so that only one renderer takes memory at a time
  offscreen_.reset();
  offscreen_.emplace(*device_, extent);
  renderer_.emplace(*device_, gpuModel_,
                    HtmRendererOptions{.maxExtent = extent, .formats = {offscreen_->target().format}});
}

HtmModelRenderer::Picture HtmModelRenderer::render(const Camera& view, const HtmSettings& settings, HtmPlanState& state,
                                                   double dtSeconds) {
  Picture picture;
  const auto begin = Clock::now();
  const HtmFramePlan plan = planHtmFrame(*model_, bounds_, {view, settings, dtSeconds}, state);
  picture.weights = millisecondsSince(begin);
  const auto planned = Clock::now();
  prepare(view.intrinsics);
  const auto recorded = Clock::now();
  picture.preparation = millisecondsSince(planned);
  picture.image = offscreen_->render([&](VkCommandBuffer commands) {
    timer_.reset(commands);
    renderer_->record(commands, plan, offscreen_->target(), &timer_);
    if (graph_) recordGraph(commands, *graph_, view, offscreen_->target());
  });
  picture.milliseconds = picture.weights + millisecondsSince(recorded);
  for (const ScopeTime& scope : timer_.read())
    (scope.name == "coordinates" ? picture.coordinates : picture.rasterisation) = scope.milliseconds;
  state = plan.next;
  return picture;
}

}  // namespace ibr::app
