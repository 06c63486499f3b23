// SPDX-License-Identifier: Apache-2.0
#include "runtime/model_renderer.h"

#include <utility>

#include "ibr/error.h"
#include "support/calls.h"

namespace ibr::python {

ModelRenderer::ModelRenderer(std::shared_ptr<const HtmModel> model, const DeviceChoice& device,
                             const HtmImageSource& source, std::optional<bool> trilinear)
    : model_(std::move(model)), device_(unlocked([&] { return deviceOf(device); })) {
  const DeviceUse use(*device_);
  gpuModel_.emplace(device_->device, *model_, source, GpuHtmModelOptions{.trilinear = trilinear});  // checks the model
  bounds_ = htmBounds(*model_);
}

ModelRenderer::~ModelRenderer() {
  const DeviceUse use(*device_);
  renderer_.reset();
  offscreen_.reset();
  gpuModel_.reset();
}

ModelPlan ModelRenderer::plan(const Camera& view, const HtmSettings& settings, double dtSeconds,
                              const ModelPlan* previous) const {
  if (previous && previous->model != model_)
    throw Error(ErrorCode::invalidInput, "previous: is a plan of another model");
  HtmPlanState state = previous ? previous->plan.next : HtmPlanState{};
  return {unlocked([&] { return planHtmFrame(*model_, bounds_, {view, settings, dtSeconds}, state); }), model_};
}

Image8 ModelRenderer::image(const ModelPlan& plan) {
  const DeviceUse use(*device_);
  if (plan.model != model_) throw Error(ErrorCode::invalidInput, "plan: is of another model");
  const Intrinsics& k = plan.plan.view.intrinsics;
  const VkExtent2D extent{std::uint32_t(k.width), std::uint32_t(k.height)};
  const auto fits = [&] {
    const VkExtent2D current = offscreen_->target().extent;
    return current.width == extent.width && current.height == extent.height;
  };
  if (!renderer_ || !offscreen_ || !fits()) {
    renderer_.reset();  // freed first, so that only one renderer takes memory at a time
    offscreen_.reset();
    offscreen_.emplace(device_->device, extent);
    renderer_.emplace(device_->device, *gpuModel_,
                      HtmRendererOptions{.maxExtent = extent, .formats = {offscreen_->target().format}});
  }
  return offscreen_->render(
      [&](VkCommandBuffer commands) { renderer_->record(commands, plan.plan, offscreen_->target()); });
}

}  // namespace ibr::python
