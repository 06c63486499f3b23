// SPDX-License-Identifier: Apache-2.0
// A harmonised model on the test device, and images of the model.
#pragma once

#include <functional>
#include <utility>

#include "ibr/htm.h"
#include "ibr/offscreen.h"
#include "ibr/scope_timer.h"
#include "support/bumpy_model.h"
#include "support/gpu.h"

namespace ibr::test {

class HtmStage {
 public:
  explicit HtmStage(HtmModel model, std::vector<HtmImage> pictures)
      : model_(std::move(model)),
        pictures_(std::move(pictures)),
        bounds_(htmBounds(model_)),
        gpuModel_(testDevice(), model_, [this](const HtmModel&, std::size_t camera) { return pictures_[camera]; },
                  {.trilinear = true}) {}
  explicit HtmStage(BumpyModel bumpy) : HtmStage(std::move(bumpy.model), std::move(bumpy.pictures)) {}
  HtmStage(const HtmStage&) = delete;
  HtmStage& operator=(const HtmStage&) = delete;

  const HtmModel& model() const { return model_; }
  const std::vector<HtmImage>& pictures() const { return pictures_; }
  const GpuHtmModel& gpuModel() const { return gpuModel_; }

  HtmFramePlan plan(const Camera& view, const HtmSettings& settings = {}) const {
    return planHtmFrame(model_, bounds_, {view, settings});
  }
  Image8 render(const HtmFramePlan& plan, TargetFormat format = VK_FORMAT_R8G8B8A8_UNORM) const {
    return rendered(plan, format, &Offscreen::render);
  }
  ImageF renderFloat(const HtmFramePlan& plan, TargetFormat format) const {
    return rendered(plan, format, &Offscreen::renderFloat);
  }
  Image8 render(const Camera& view, const HtmSettings& settings = {}) const { return render(plan(view, settings)); }

 private:
  using Record = std::function<void(VkCommandBuffer)>;
  template <class T>
  Image<T> rendered(const HtmFramePlan& plan, TargetFormat format,
                    Image<T> (Offscreen::*picture)(const Record&)) const {
    const VkExtent2D extent{std::uint32_t(plan.view.intrinsics.width), std::uint32_t(plan.view.intrinsics.height)};
    const HtmRenderer renderer(testDevice(), gpuModel_, {.maxExtent = extent, .formats = {format}});
    Offscreen offscreen(testDevice(), extent, format);
    return (offscreen.*picture)([&](VkCommandBuffer commands) { renderer.record(commands, plan, offscreen.target()); });
  }

  HtmModel model_;
  std::vector<HtmImage> pictures_;
  HtmBounds bounds_;
  GpuHtmModel gpuModel_;
};

}  // namespace ibr::test
