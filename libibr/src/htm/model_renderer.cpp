// SPDX-License-Identifier: Apache-2.0
#include <cassert>

#include "htm/coordinates_pass.h"
#include "htm/draw_pass.h"
#include "htm/frame_set.h"
#include "ibr/htm.h"
#include "ibr/scope_timer.h"

namespace ibr {

struct HtmRenderer::State {
  State(Device& on, const GpuHtmModel& model, const HtmRendererOptions& options)
      : device(&on),
        largest(options.maxExtent),
        set(on, stateOf(model)),
        coordinates(on, set),
        draw(on, set, options) {}

  const Device* device;
  VkExtent2D largest;
  HtmFrameSet set;
  HtmCoordinatesPass coordinates;
  HtmDrawPass draw;
};

HtmRenderer::HtmRenderer(Device& device, const GpuHtmModel& model, const HtmRendererOptions& options)
    : state_(std::make_unique<State>(device, model, options)) {}
HtmRenderer::HtmRenderer(HtmRenderer&&) noexcept = default;
HtmRenderer& HtmRenderer::operator=(HtmRenderer&&) noexcept = default;
HtmRenderer::~HtmRenderer() = default;

void HtmRenderer::setModel(const GpuHtmModel& model) {
  state_->set.show(*state_->device, stateOf(model));
}

void HtmRenderer::record(VkCommandBuffer commandBuffer, const HtmFramePlan& plan, const Target& target,
                         ScopeTimer* timer) const noexcept {
  const State& s = *state_;
  assert(target.extent.width <= s.largest.width && target.extent.height <= s.largest.height);
  assert(int(target.extent.width) == plan.view.intrinsics.width &&
         int(target.extent.height) == plan.view.intrinsics.height);
  if (!plan.cameras.empty()) {
    const GpuScope scope(commandBuffer, timer, "coordinates");
    s.set.update(commandBuffer, plan);
    s.coordinates.record(commandBuffer, s.set, plan);
  }
  const GpuScope scope(commandBuffer, timer, "rasterisation");
  s.draw.record(commandBuffer, s.set, plan, target);
}

}  // namespace ibr
