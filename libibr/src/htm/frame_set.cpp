// SPDX-License-Identifier: Apache-2.0
#include "htm/frame_set.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/pipeline.h"
#include "gpu/draw/descriptors.h"
#include "htm/projection.h"

namespace ibr {
namespace {

constexpr VkShaderStageFlags kStages =
    VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT | VK_SHADER_STAGE_COMPUTE_BIT;
constexpr BufferUse kReads{VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT |
                               VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                           VK_ACCESS_2_SHADER_STORAGE_READ_BIT};

double focalLength(const Intrinsics& k) {
  return std::sqrt(k.fx * k.fy);
}

// The mesh's nearest possible depth in the view; at least a thousandth of its radius.
double nearDistanceOf(const HtmFramePlan& plan, const HtmProjection& projection) {
  return std::max(0.5 * (projection.depthOf.w - plan.bounds.radius), 1e-3 * plan.bounds.radius);
}

}  // namespace

HtmFrameSet::HtmFrameSet(const Device& device, const GpuHtmModel::State& model) {
  std::array<VkDescriptorSetLayoutBinding, shader::kHtmBindingCount> bindings{};
  for (std::uint32_t b = 0; b < bindings.size(); ++b) {
    const bool image = b == shader::kBindingHtmPhotographs || b == shader::kBindingHtmDepths;
    bindings[b] = {b, image ? VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, kStages,
                   nullptr};
  }
  setLayout_ = makeSetLayout(device, bindings);
  const VkDescriptorPoolSize sizes[]{{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, shader::kHtmBindingCount - 2},
                                     {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 2}};
  pool_ = makeDescriptorPool(device, 1, sizes);
  set_ = allocateSet(device, pool_.get(), setLayout_.get());
  const VkPushConstantRange constants{kStages, 0, sizeof(shader::HtmFrame)};
  const VkDescriptorSetLayout layouts[]{setLayout_.get()};
  layout_ = makePipelineLayout(device, layouts, {&constants, 1});
  show(device, model);
}

void HtmFrameSet::show(const Device& device, const GpuHtmModel::State& model) {
  model_ = &model;
  const VkDeviceSize vertices = std::max(model.vertexCount, 1u), count = model.cameras.size();
  makeHtmBuffer(device, cameras_, count * sizeof(shader::HtmCameraParameters), "planned cameras");
  makeHtmBuffer(device, displacements_, (model.hasComplements ? count * vertices : 1) * sizeof(glm::vec2),
                "harmonised displacements");
  makeHtmBuffer(device, ranked_, vertices * sizeof(glm::uvec2), "members by rank");
  makeHtmBuffer(device, colours_, vertices * sizeof(glm::vec4), "vertex colours");
  writeStorageBuffer(device, set_, shader::kBindingHtmPositions, model.positions.get());
  writeStorageBuffer(device, set_, shader::kBindingHtmTriangles, model.triangles.get());
  writeStorageBuffer(device, set_, shader::kBindingHtmMembers, model.members.get());
  writeStorageBuffer(device, set_, shader::kBindingHtmComplements, model.complements.get());
  writeStorageBuffer(device, set_, shader::kBindingHtmCameras, cameras_.get());
  writeStorageBuffer(device, set_, shader::kBindingHtmDisplacements, displacements_.get());
  writeStorageBuffer(device, set_, shader::kBindingHtmColours, colours_.get());
  writeStorageBuffer(device, set_, shader::kBindingHtmRanked, ranked_.get());
  writeSampledImage(device, set_, shader::kBindingHtmPhotographs, model.photographSampler.get(),
                    model.photographs.view());
  writeSampledImage(device, set_, shader::kBindingHtmDepths, model.depthSampler.get(), model.depths.view());
}

void HtmFrameSet::update(VkCommandBuffer commands, const HtmFramePlan& plan) const noexcept {
  std::array<shader::HtmCameraParameters, kMaxHtmCameraCount> parameters;
  for (std::size_t k = 0; k < plan.cameras.size(); ++k) {
    const PlannedHtmCamera& planned = plan.cameras[k];
    const Camera& camera = model_->cameras[planned.camera];
    const HtmProjection projection = htmProjection(camera, model_->bounds.middle);
    const Intrinsics& intrinsics = camera.intrinsics;
    parameters[k] = {.column = glm::vec4(projection.column),
                     .row = glm::vec4(projection.row),
                     .depthOf = glm::vec4(projection.depthOf),
                     .size = {float(intrinsics.width), float(intrinsics.height)},
                     .log2Weight = float(planned.logWeight / std::numbers::ln2),
                     .log2Rest = float(std::max(planned.logRemainingWeight / std::numbers::ln2, -1e30)),
                     .detail = float(focalLength(intrinsics) / focalLength(plan.view.intrinsics)),
                     .texelWidth = float(1 / focalLength(intrinsics)),
                     .nearDistance = float(model_->nearDistance[planned.camera]),
                     .camera = planned.camera};
  }
  // The command buffer contains the data, so frames may be recorded ahead in any number, or never submitted.
  bufferBarrier(commands, kReads, use::kTransferWrite);
  vkCmdUpdateBuffer(commands, cameras_.get(), 0, plan.cameras.size() * sizeof parameters[0], parameters.data());
  bufferBarrier(commands, use::kTransferWrite, kReads);
}

shader::HtmFrame HtmFrameSet::frame(const HtmFramePlan& plan) const noexcept {
  const HtmProjection projection = htmProjection(plan.view, model_->bounds.middle);
  return {.clip = htmClip(projection, plan.view.intrinsics, nearDistanceOf(plan, projection)),
          .background = plan.settings.background,
          .cut = float(plan.settings.weightCut),
          .depthTolerance = float(plan.settings.depthTolerance * plan.bounds.radius),
          .vertexCount = model_->vertexCount,
          .cameraCount = std::uint32_t(model_->cameras.size()),
          .plannedCount = std::uint32_t(plan.cameras.size())};
}

void HtmFrameSet::bind(VkCommandBuffer commands, VkPipelineBindPoint point,
                       const shader::HtmFrame& frame) const noexcept {
  vkCmdBindDescriptorSets(commands, point, layout_.get(), 0, 1, &set_, 0, nullptr);
  vkCmdPushConstants(commands, layout_.get(), kStages, 0, sizeof frame, &frame);
}

}  // namespace ibr
