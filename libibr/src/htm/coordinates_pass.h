// SPDX-License-Identifier: Apache-2.0
// What a frame computes for each vertex: its members in the plan's order, and harmonised coordinates ([H] eq. 6), or
// for HtmMethod::vertexColours its colour.
#pragma once

#include "gpu/handle.h"
#include "htm/frame_set.h"

namespace ibr {

class HtmCoordinatesPass {
 public:
  HtmCoordinatesPass(const Device& device, const HtmFrameSet& set);

  /// Outside a render pass, after HtmFrameSet::update. Waits for earlier frames' reads of what it writes, and makes it
  /// visible to fragment shaders.
  void record(VkCommandBuffer commands, const HtmFrameSet& set, const HtmFramePlan& plan) const noexcept;

 private:
  PipelineHandle rank_, harmonise_, colours_;
};

/// Whether photographs are read elsewhere than where a vertex is projected.
inline bool htmDisplaces(const GpuHtmModel::State& model, const HtmFramePlan& plan) {
  return model.hasComplements && plan.settings.method == HtmMethod::harmonised;
}

}  // namespace ibr
