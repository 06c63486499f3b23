// SPDX-License-Identifier: Apache-2.0
// Method `compute`: a picture's classes in one submission, or a class each where a guard must be asked in between.
#include <vector>

#include "gpu/barrier.h"
#include "gpu/pipeline.h"
#include "gpu/submit.h"
#include "optimise/alignment_buffers.h"
#include "optimise/mover.h"
#include "shaders/ecc_judge_comp.h"
#include "shaders/ecc_move_comp.h"

namespace ibr {
namespace {

class ComputeMover final : public Mover {
 public:
  ComputeMover(const MoverInput& input, const Device& device)
      : input_(input), device_(device), buffers_(device, input.mesh, input.pictures), submission_(device) {
    const VkDescriptorSetLayout set = buffers_.layout();
    const VkPushConstantRange step{VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(shader::AlignmentStep)};
    layout_ = makePipelineLayout(device, {&set, 1}, {&step, 1});
    judge_ =
        makeComputePipeline(device, {.name = "ECC: judge", .shader = shaders::ecc_judge_comp, .layout = layout_.get()});
    move_ =
        makeComputePipeline(device, {.name = "ECC: move", .shader = shaders::ecc_move_comp, .layout = layout_.get()});
  }

  CycleCounts cycle(const CycleRequest& request, Positions& at, const KeepGoing& keepGoing) override {
    CycleCounts counts;
    buffers_.upload(device_, at);
    const std::size_t classes = input_.mesh.colours.first.size() - 1;
    for (std::size_t member = 0; member < at.size(); ++member) {
      const std::size_t together = input_.options.guard ? 1 : classes;
      for (std::size_t c = 0; c < classes; c += together) {
        submission_.run([&](VkCommandBuffer commands) {
          for (std::size_t k = c; k < c + together; ++k) recordMove(commands, request, member, k);
          buffers_.recordReadback(commands);
        });
        const std::size_t first = input_.mesh.colours.first[c], last = input_.mesh.colours.first[c + together];
        take(first, last, member, at, counts);
        keepGoing();
      }
    }
    return counts;
  }

  std::vector<Judgement> judgeAll(const Positions& at) override {
    const std::size_t n = input_.mesh.pointCount();
    buffers_.upload(device_, at);
    submission_.run([&](VkCommandBuffer commands) {
      bind(commands, judge_.get());
      for (std::size_t member = 0; member < at.size(); ++member) {
        push(commands, {.member = std::uint32_t(member)});
        vkCmdDispatch(commands, std::uint32_t((n + shader::kAlignmentGroup - 1) / shader::kAlignmentGroup), 1, 1);
      }
      buffers_.recordJudgementReadback(commands);
    });
    std::vector<Judgement> all(at.size() * n);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const shader::AlignmentJudgement& judged = buffers_.judgements()[i];
      all[i].count = int(at.size()) - 1;
      for (std::size_t t = 0; t < 3; ++t) all[i].targets[t] = judged.targets[t];
      all[i].whole = judged.whole != 0;
    }
    return all;
  }

 private:
  void bind(VkCommandBuffer commands, VkPipeline pipeline) const noexcept {
    const VkDescriptorSet set = buffers_.set();
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout_.get(), 0, 1, &set, 0, nullptr);
  }

  void push(VkCommandBuffer commands, const shader::AlignmentStep& step) const noexcept {
    vkCmdPushConstants(commands, layout_.get(), VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof step, &step);
  }

  void recordMove(VkCommandBuffer commands, const CycleRequest& request, std::size_t member,
                  std::size_t c) const noexcept {
    const AlignmentOptions& options = input_.options;
    const Rows<std::uint32_t>& colours = input_.mesh.colours;
    bind(commands, move_.get());
    push(commands,
         {.member = std::uint32_t(member),
          .first = colours.first[c],
          .radius = request.radius,
          .seed = request.seed,
          .instances = std::uint32_t(options.instances),
          .scaled = options.scaledInstances,
          .definition = options.definition == EccDefinition::channels ? shader::kEccChannels : shader::kEccConcatenated,
          .prune = options.prune,
          .firstOutcome = firstOutcome(member) + colours.first[c],
          .floor = floorOf(options.varianceFloor)});
    vkCmdDispatch(commands, colours.first[c + 1] - colours.first[c], 1, 1);
    bufferBarrier(commands, use::kComputeReadWrite, use::kComputeReadWrite);
  }

  std::uint32_t firstOutcome(std::size_t member) const {
    return std::uint32_t(member * input_.mesh.colours.values.size());
  }

  // Points [first, last) of the list have been moved in this picture.
  void take(std::size_t first, std::size_t last, std::size_t member, Positions& at, CycleCounts& counts) {
    std::vector<Moved> moved;
    for (std::size_t i = first; i < last; ++i) {
      const std::uint32_t point = input_.mesh.colours.values[i];
      const shader::AlignmentOutcome& outcome = buffers_.outcomes()[firstOutcome(member) + i];
      counts.mutations += outcome.mutations;
      counts.pixels += std::uint64_t(outcome.pixels);
      if (outcome.offset == glm::ivec2(0)) continue;
      moved.push_back({point, at[member][point]});
      at[member][point] = buffers_.positions()[member * input_.mesh.pointCount() + point];
    }
    const std::size_t refused = counts.refused;
    askGuard(input_.options.guard, moved, member, at, counts);
    if (counts.refused != refused) buffers_.upload(device_, at);
  }

  const MoverInput input_;
  const Device& device_;
  AlignmentBuffers buffers_;
  Submission submission_;
  PipelineLayoutHandle layout_;
  PipelineHandle judge_, move_;
};

}  // namespace

std::unique_ptr<Mover> computeMover(const MoverInput& input, const Device& device) {
  return std::make_unique<ComputeMover>(input, device);
}

}  // namespace ibr
