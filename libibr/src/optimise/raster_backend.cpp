// SPDX-License-Identifier: Apache-2.0
// Method `raster` of the paper ([T] §3.6–3.7), point by point. Draws the star once per candidate as instances;
// fragments add to their candidate's sums. A second pass picks the winner, whose offset is read back.
//
// Departures: the device returns the displacement instead of the winner's index. The drawn area is the star's, which
// saves work that the paper's method does not need.
#include <algorithm>
#include <vector>

#include "base/check.h"
#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/gpu_image.h"
#include "base/vulkan/pipeline.h"
#include "base/vulkan/submit.h"
#include "gpu/draw/descriptors.h"
#include "gpu/transfer/upload.h"
#include "optimise/alignment_buffers.h"
#include "optimise/processor.h"
#include "shaders/ecc_pick_comp.h"
#include "shaders/ecc_raster_frag.h"
#include "shaders/ecc_raster_vert.h"

namespace ibr {
namespace {

constexpr VkShaderStageFlags kStages =
    VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT | VK_SHADER_STAGE_COMPUTE_BIT;
constexpr float kViewport = 16384;  // px; shaders/optimise/ecc_raster.vert

GpuImage imageOf(const Device& device, const Texels& texels, glm::ivec2 size, Uploader& uploader) {
  GpuImage image(device,
                 {.format = VK_FORMAT_R8G8B8A8_UNORM,
                  .extent = {std::uint32_t(size.x), std::uint32_t(size.y)},
                  .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT},
                 "image to align");
  std::vector<std::uint32_t> words;
  for (int y = 0; y < size.y; ++y)
    for (int x = 0; x < size.x; ++x) words.push_back(*texels.at(x, y) ^ 0x808080u);
  uploader.image(image, 0, 0, image.info().extent, std::as_bytes(std::span(words)));
  return image;
}

class RasterBackend final : public AlignmentBackend {
 public:
  RasterBackend(const BackendInput& input, const Device& device, Uploader&& uploader)
      : input_(input),
        device_(device),
        buffers_(device, input.mesh, input.pictures, input.alignment.position, uploader),
        submission_(device) {
    check(device.supportsInt64Atomics(), ErrorCode::unsupported,
          "{}: shaderBufferInt64Atomics is not supported; align with method compute or cpu", device.name());
    definition_ = input.options.definition == EccDefinition::channels ? shader::kEccChannels : shader::kEccConcatenated;
    sums_ = Buffer(device,
                   VkDeviceSize(input.options.instances) * sizeof(std::int64_t) * shader::kEccSums *
                       shader::eccSlots(definition_, std::uint32_t(input.mesh.memberCount())),
                   VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryKind::device,
                   "sums of candidates");
    makePictures(uploader);
    makePairs();
    makePipelines();
    uploader.flush();
  }

  CycleCounts cycle(const CycleRequest& request, Positions& at, const KeepGoing& keepGoing) override {
    CycleCounts counts;
    buffers_.upload(device_, at);
    for (std::size_t member = 0; member < at.size(); ++member)
      for (std::uint32_t point = 0; point < input_.mesh.vertexCount(); ++point) {
        movePoint(request, member, point, at, counts);
        if (point % 64 == 0) keepGoing();
      }
    return counts;
  }

  /// Exact, as for all methods.
  std::vector<Judgement> judgeAll(const Positions& at) override { return judgeAllOnCpu(input_, at); }

 private:
  void makePictures(Uploader& uploader) {
    const VkSamplerCreateInfo bilinear{.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                       .magFilter = VK_FILTER_LINEAR,
                                       .minFilter = VK_FILTER_LINEAR,
                                       .addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                       .addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                       .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE};
    sampler_ = make<SamplerHandle>(device_, vkCreateSampler, bilinear, "vkCreateSampler");
    for (std::size_t i = 0; i < input_.pictures.size(); ++i)
      images_.push_back(imageOf(device_, input_.pictures[i], input_.mesh.size[i], uploader));
  }

  // Makes a set per source and target; the set of an image with itself stays unused.
  void makePairs() {
    const std::uint32_t d = std::uint32_t(images_.size());
    const VkDescriptorSetLayoutBinding bindings[]{
        {shader::kBindingSource, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, kStages, nullptr},
        {shader::kBindingTarget, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, kStages, nullptr},
        {shader::kBindingSumsOf, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, kStages, nullptr}};
    pairLayout_ = makeSetLayout(device_, bindings);
    const VkDescriptorPoolSize sizes[]{{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 2 * d * d},
                                       {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, d * d}};
    pool_ = makeDescriptorPool(device_, d * d, sizes);
    for (std::uint32_t i = 0; i < d; ++i)
      for (std::uint32_t k = 0; k < d; ++k) {
        const VkDescriptorSet set = allocateSet(device_, pool_.get(), pairLayout_.get());
        writeSampledImage(device_, set, shader::kBindingSource, sampler_.get(), images_[i].view());
        writeSampledImage(device_, set, shader::kBindingTarget, sampler_.get(), images_[k].view());
        writeStorageBuffer(device_, set, shader::kBindingSumsOf, sums_.get());
        pairs_.push_back(set);
      }
  }

  void makePipelines() {
    const VkDescriptorSetLayout sets[]{buffers_.layout(), pairLayout_.get()};
    const VkPushConstantRange step{kStages, 0, sizeof(shader::AlignmentStep)};
    layout_ = makePipelineLayout(device_, sets, {&step, 1});
    draw_ = makeGraphicsPipeline(device_, {.name = "ECC: draw candidates",
                                           .vertex = shaders::ecc_raster_vert,
                                           .fragment = shaders::ecc_raster_frag,
                                           .layout = layout_.get(),
                                           .attachments = false});
    pick_ =
        makeComputePipeline(device_, {.name = "ECC: pick", .shader = shaders::ecc_pick_comp, .layout = layout_.get()});
  }

  void movePoint(const CycleRequest& request, std::size_t member, std::uint32_t point, Positions& at,
                 CycleCounts& counts) {
    const int reach = maxMove(input_.mesh, at, point, member, request.radius);
    if (reach == 0) return;
    const auto most = std::uint32_t(input_.options.instances);
    shader::AlignmentStep step{
        .member = std::uint32_t(member),
        .first = point,
        .radius = reach,
        .seed = request.seed,
        .instances = input_.options.scaledInstances ? shader::eccCandidateCount(most, reach, request.radius) : most,
        .definition = definition_,
        .floor = scoreUnits(input_.options.varianceFloor),
        .rigidity = scoreUnits(input_.options.rigidity)};
    submission_.run([&](VkCommandBuffer commands) { record(commands, step, at); });

    const shader::AlignmentOutcome& outcome = buffers_.outcomes()[0];
    counts.mutations += outcome.mutations;
    counts.pixels += std::uint64_t(outcome.pixels);
    if (outcome.offset == glm::ivec2(0)) return;
    const Moved moved{point, at[member][point]};
    at[member][point] += outcome.offset;
    const std::size_t refused = counts.refused;
    applyGuard(input_.options.guard, {&moved, 1}, member, at, counts);
    if (counts.refused != refused) buffers_.upload(device_, at);
  }

  void record(VkCommandBuffer commands, shader::AlignmentStep step, const Positions& at) const noexcept {
    vkCmdFillBuffer(commands, sums_.get(), 0, VK_WHOLE_SIZE, 0);
    bufferBarrier(commands, use::kTransferWrite, kFragmentAdd);
    for (std::uint32_t k = 0; k < images_.size(); ++k) {
      if (k == step.member) continue;
      step.target = k;
      recordDraw(commands, step, drawArea(step, at));
    }
    bufferBarrier(commands, kFragmentAdd, use::kComputeReadWrite);
    bind(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pick_.get(), step);
    vkCmdDispatch(commands, 1, 1, 1);
    buffers_.recordOutcomeReadback(commands, 0, 1);
  }

  void recordDraw(VkCommandBuffer commands, const shader::AlignmentStep& step, VkRect2D area) const noexcept {
    const VkRenderingInfo rendering{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO, .renderArea = area, .layerCount = 1};
    const VkViewport viewport{0, 0, kViewport, kViewport, 0, 1};
    vkCmdBeginRendering(commands, &rendering);
    bind(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, draw_.get(), step);
    vkCmdSetViewport(commands, 0, 1, &viewport);
    vkCmdSetScissor(commands, 0, 1, &area);
    vkCmdDraw(commands, std::uint32_t(3 * input_.mesh.star[step.first].size()), step.instances, 0, 0);
    vkCmdEndRendering(commands);
  }

  void bind(VkCommandBuffer commands, VkPipelineBindPoint point, VkPipeline pipeline,
            const shader::AlignmentStep& step) const noexcept {
    const VkDescriptorSet sets[]{buffers_.set(), pairs_[step.member * images_.size() + step.target]};
    vkCmdBindPipeline(commands, point, pipeline);
    vkCmdBindDescriptorSets(commands, point, layout_.get(), 0, 2, sets, 0, nullptr);
    vkCmdPushConstants(commands, layout_.get(), kStages, 0, sizeof step, &step);
  }

  // Pixels that the star may cover for any of its candidates.
  VkRect2D drawArea(const shader::AlignmentStep& step, const Positions& at) const noexcept {
    const auto mean = [&](std::uint32_t p) { return at[step.member][p] + at[step.target][p]; };
    glm::ivec2 least = mean(step.first) - step.radius, most = mean(step.first) + step.radius;
    for (const glm::uvec2& edge : input_.mesh.star[step.first])
      for (const std::uint32_t p : {edge.x, edge.y}) least = glm::min(least, mean(p)), most = glm::max(most, mean(p));
    least = glm::max(least >> 8, glm::ivec2(0));
    most = glm::max((most >> 8) + 1, least + 1);
    return {{least.x, least.y}, {std::uint32_t(most.x - least.x), std::uint32_t(most.y - least.y)}};
  }

  static constexpr BufferUse kFragmentAdd{VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT,
                                          VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT};

  const BackendInput input_;
  const Device& device_;
  AlignmentBuffers buffers_;
  Submission submission_;
  std::uint32_t definition_ = 0;
  Buffer sums_;
  SamplerHandle sampler_;
  std::vector<GpuImage> images_;
  DescriptorSetLayoutHandle pairLayout_;
  DescriptorPoolHandle pool_;
  std::vector<VkDescriptorSet> pairs_;  // [source · d + target]
  PipelineLayoutHandle layout_;
  PipelineHandle draw_, pick_;
};

}  // namespace

std::unique_ptr<AlignmentBackend> makeRasterBackend(const BackendInput& input, const Device& device) {
  return std::make_unique<RasterBackend>(input, device, Uploader(device));
}

}  // namespace ibr
