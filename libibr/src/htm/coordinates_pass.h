// SPDX-License-Identifier: Apache-2.0
// Computes per frame, for each vertex: its members in the plan's order, and harmonised coordinates ([H] eq. 6) or, for
// HtmMethod::vertexColours, its colour.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <limits>

#include "base/vulkan/handle.h"
#include "htm/frame_set.h"

namespace ibr {

/// Splits `groups` workgroups into rows of at most `most`: returns groups per row and rows. The last row may have some
/// unneeded groups, fewer than the number of rows.
inline glm::uvec2 htmDispatchGroups(std::uint32_t groups, std::uint32_t most) {
  const std::uint32_t rows = groups / most + (groups % most != 0);
  return {rows == 0 ? 0 : groups / rows + (groups % rows != 0), rows};
}

class HtmCoordinatesPass {
 public:
  /// `maxGroups` per row, at least 1, for tests; limited by the device's maxComputeWorkGroupCount.
  HtmCoordinatesPass(const Device& device, const HtmFrameSet& set,
                     std::uint32_t maxGroups = std::numeric_limits<std::uint32_t>::max());

  /// Call outside a render pass, after HtmFrameSet::update. Waits for earlier frames' reads of the pass's outputs, and
  /// makes the outputs visible to fragment shaders.
  void record(VkCommandBuffer commands, const HtmFrameSet& set, const HtmFramePlan& plan) const noexcept;

 private:
  PipelineHandle rank_, harmonise_, colours_;
  std::uint32_t maxGroups_;
};

/// True if photographs are sampled at an offset from the projection of the vertices.
inline bool htmDisplaces(const GpuHtmModel::State& model, const HtmFramePlan& plan) {
  return model.hasComplements && plan.settings.method == HtmMethod::harmonised;
}

}  // namespace ibr
