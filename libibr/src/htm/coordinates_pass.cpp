// SPDX-License-Identifier: Apache-2.0
#include "htm/coordinates_pass.h"

#include "gpu/barrier.h"
#include "gpu/pipeline.h"
#include "shaders/htm_colours_comp.h"
#include "shaders/htm_harmonise_comp.h"

namespace ibr {

HtmCoordinatesPass::HtmCoordinatesPass(const Device& device, const HtmFrameSet& set)
    : harmonise_(makeComputePipeline(
          device, {.name = "harmonise", .shader = shaders::htm_harmonise_comp, .layout = set.layout()})),
      colours_(makeComputePipeline(
          device, {.name = "vertex colours", .shader = shaders::htm_colours_comp, .layout = set.layout()})) {}

void HtmCoordinatesPass::record(VkCommandBuffer commands, const HtmFrameSet& set,
                                const HtmFramePlan& plan) const noexcept {
  const bool colours = plan.settings.method == HtmMethod::vertexColours;
  if ((!colours && !htmDisplaces(set.model(), plan)) || set.model().vertexCount == 0) return;
  bufferBarrier(commands, use::kShaderRead, use::kComputeReadWrite);
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, (colours ? colours_ : harmonise_).get());
  set.bind(commands, VK_PIPELINE_BIND_POINT_COMPUTE, set.frame(plan));
  const std::uint32_t groups = (set.model().vertexCount + shader::kHtmGroupSize - 1) / shader::kHtmGroupSize;
  vkCmdDispatch(commands, groups, colours ? 1 : std::uint32_t(plan.cameras.size()), 1);
  bufferBarrier(commands, use::kComputeReadWrite, use::kShaderRead);
}

}  // namespace ibr
