// SPDX-License-Identifier: Apache-2.0
#include "optimise/alignment_pass.h"

#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/pipeline.h"
#include "shaders/ecc_judge_comp.h"
#include "shaders/ecc_move_comp.h"

namespace ibr {

AlignmentPass::AlignmentPass(const Device& device, const StarMesh& mesh, std::span<const Texels> pictures,
                             const Positions& starts, const AlignmentOptions& options, Uploader& uploader)
    : buffers_(device, mesh, pictures, starts, uploader),
      members_(std::uint32_t(mesh.memberCount())),
      points_(std::uint32_t(mesh.vertexCount())),
      firstOfClass_(mesh.colours.first),
      options_{
          .instances = std::uint32_t(options.instances),
          .scaled = options.scaledInstances,
          .definition = options.definition == EccDefinition::channels ? shader::kEccChannels : shader::kEccConcatenated,
          .prune = options.prune,
          .floor = scoreUnits(options.varianceFloor),
          .rigidity = scoreUnits(options.rigidity)} {
  const VkDescriptorSetLayout set = buffers_.layout();
  const VkPushConstantRange step{VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(shader::AlignmentStep)};
  layout_ = makePipelineLayout(device, {&set, 1}, {&step, 1});
  judge_ =
      makeComputePipeline(device, {.name = "ECC: judge", .shader = shaders::ecc_judge_comp, .layout = layout_.get()});
  move_ = makeComputePipeline(device, {.name = "ECC: move", .shader = shaders::ecc_move_comp, .layout = layout_.get()});
}

void AlignmentPass::bind(VkCommandBuffer commands, VkPipeline pipeline) const noexcept {
  const VkDescriptorSet set = buffers_.set();
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout_.get(), 0, 1, &set, 0, nullptr);
}

void AlignmentPass::push(VkCommandBuffer commands, const shader::AlignmentStep& step) const noexcept {
  vkCmdPushConstants(commands, layout_.get(), VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof step, &step);
}

void AlignmentPass::recordMove(VkCommandBuffer commands, const ClassMove& move) const noexcept {
  const std::uint32_t first = firstOfClass_[move.pointClass];
  shader::AlignmentStep step = options_;
  step.member = move.member;
  step.first = first;
  step.radius = move.radius;
  step.seed = move.seed;
  step.firstOutcome = firstOutcome(move.member) + first;
  bind(commands, move_.get());
  push(commands, step);
  vkCmdDispatch(commands, firstOfClass_[move.pointClass + 1] - first, 1, 1);
  bufferBarrier(commands, use::kComputeReadWrite, use::kComputeReadWrite);
}

void AlignmentPass::recordEvaluation(VkCommandBuffer commands) const noexcept {
  bind(commands, judge_.get());
  for (std::uint32_t member = 0; member < members_; ++member) {
    shader::AlignmentStep step = options_;
    step.member = member;
    push(commands, step);
    vkCmdDispatch(commands, (points_ + shader::kAlignmentGroup - 1) / shader::kAlignmentGroup, 1, 1);
  }
  bufferBarrier(commands, use::kComputeReadWrite, use::kComputeReadWrite);
}

std::vector<Judgement> AlignmentPass::judgements() const {
  std::vector<Judgement> all(std::size_t(members_) * points_);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const shader::AlignmentJudgement& judged = buffers_.judgements()[i];
    all[i].count = int(members_) - 1;
    for (std::size_t t = 0; t < 3; ++t) all[i].targets[t] = judged.targets[t];
    all[i].whole = judged.whole != 0;
  }
  return all;
}

}  // namespace ibr
