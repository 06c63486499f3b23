// SPDX-License-Identifier: Apache-2.0
#include "htm/coordinates_pass.h"

#include <algorithm>

#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/pipeline.h"
#include "shaders/htm_colours_comp.h"
#include "shaders/htm_harmonise_comp.h"
#include "shaders/htm_rank_comp.h"

namespace ibr {

HtmCoordinatesPass::HtmCoordinatesPass(const Device& device, const HtmFrameSet& set, std::uint32_t maxGroups)
    : rank_(makeComputePipeline(device,
                                {.name = "rank members", .shader = shaders::htm_rank_comp, .layout = set.layout()})),
      harmonise_(makeComputePipeline(
          device, {.name = "harmonise", .shader = shaders::htm_harmonise_comp, .layout = set.layout()})),
      colours_(makeComputePipeline(
          device, {.name = "vertex colours", .shader = shaders::htm_colours_comp, .layout = set.layout()})),
      maxGroups_(std::min(maxGroups, device.properties().limits.maxComputeWorkGroupCount[0])) {}

void HtmCoordinatesPass::record(VkCommandBuffer commands, const HtmFrameSet& set,
                                const HtmFramePlan& plan) const noexcept {
  if (set.model().vertexCount == 0) return;
  const bool colours = plan.settings.method == HtmMethod::vertexColours;
  const glm::uvec2 groups = htmDispatchGroups((set.model().vertexCount - 1) / shader::kHtmGroupSize + 1, maxGroups_);
  bufferBarrier(commands, use::kShaderRead, use::kComputeReadWrite);
  set.bind(commands, VK_PIPELINE_BIND_POINT_COMPUTE, set.frame(plan));
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, rank_.get());
  vkCmdDispatch(commands, groups.x, 1, groups.y);
  if (colours || htmDisplaces(set.model(), plan)) {
    bufferBarrier(commands, use::kComputeReadWrite, use::kComputeReadWrite);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, (colours ? colours_ : harmonise_).get());
    vkCmdDispatch(commands, groups.x, colours ? 1 : std::uint32_t(plan.cameras.size()), groups.y);
  }
  bufferBarrier(commands, use::kComputeReadWrite, use::kShaderRead);
}

}  // namespace ibr
