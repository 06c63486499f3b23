// SPDX-License-Identifier: Apache-2.0
// Moves and judges points on the device: pipelines over AlignmentBuffers.
#pragma once

#include "optimise/alignment_buffers.h"
#include "optimise/judge.h"

namespace ibr {

/// Move of one class of points in one image.
struct ClassMove {
  std::uint32_t member = 0, pointClass = 0;
  int radius = 0;  // 1/128 px
  std::uint32_t seed = 0;
};

class AlignmentPass {
 public:
  AlignmentPass(const Device& device, const StarMesh& mesh, std::span<const Texels> pictures, const Positions& starts,
                const AlignmentOptions& options, Uploader& uploader);

  void upload(const Device& device, const Positions& at) { buffers_.upload(device, at); }
  void upload(const Positions& at, Uploader& uploader) { buffers_.upload(at, uploader); }

  /// Each ends with a barrier. Outcomes of an image's points are contiguous, in the order of the classes.
  void recordMove(VkCommandBuffer commands, const ClassMove& move) const noexcept;
  void recordEvaluation(VkCommandBuffer commands) const noexcept;
  const AlignmentBuffers& buffers() const noexcept { return buffers_; }

  std::uint32_t classCount() const noexcept { return std::uint32_t(firstOfClass_.size()) - 1; }
  std::uint32_t firstOutcome(std::uint32_t member) const noexcept { return member * firstOfClass_.back(); }

  /// Results of recordEvaluation after the readback, image by image.
  std::vector<Judgement> judgements() const;

 private:
  void bind(VkCommandBuffer commands, VkPipeline pipeline) const noexcept;
  void push(VkCommandBuffer commands, const shader::AlignmentStep& step) const noexcept;

  AlignmentBuffers buffers_;
  std::uint32_t members_, points_;
  std::vector<std::uint32_t> firstOfClass_;
  shader::AlignmentStep options_;  // parameters that all steps share
  PipelineLayoutHandle layout_;
  PipelineHandle judge_, move_;
};

}  // namespace ibr
