// SPDX-License-Identifier: Apache-2.0
// A mesh to be aligned and its photographs in device memory, with the passes' descriptor set (shared/alignment.h).
#pragma once

#include <span>
#include <vector>

#include "base/vulkan/buffer.h"
#include "base/vulkan/handle.h"
#include "gpu/transfer/upload.h"
#include "optimise/star_mesh.h"
#include "optimise/texels.h"
#include "shared/alignment.h"

namespace ibr {

class AlignmentBuffers {
 public:
  /// Uploads everything but the positions; `starts`: positions before the first cycle. The caller flushes. Throws
  /// Error: unsupported without 64-bit integers or if the photographs exceed one buffer; outOfMemory, deviceLost.
  AlignmentBuffers(const Device& device, const StarMesh& mesh, std::span<const Texels> pictures,
                   const Positions& starts, Uploader& uploader);

  VkDescriptorSetLayout layout() const noexcept { return layout_.get(); }
  VkDescriptorSet set() const noexcept { return set_; }

  /// Uploads positions. Without an uploader: submits and waits.
  void upload(const Positions& at, Uploader& uploader) { upload(at, shader::kBindingPositions, uploader); }
  void upload(const Device& device, const Positions& at);

  /// Record copies of the outputs of earlier passes to the host; end in use::kHostRead.
  void recordPositionReadback(VkCommandBuffer commands) const noexcept;
  void recordOutcomeReadback(VkCommandBuffer commands, std::uint32_t first, std::uint32_t count) const noexcept;
  void recordJudgementReadback(VkCommandBuffer commands) const noexcept;

  /// Results of the last readback.
  std::span<const glm::ivec2> positions() const noexcept;                   // d × n
  std::span<const shader::AlignmentOutcome> outcomes() const noexcept;      // d × movable points
  std::span<const shader::AlignmentJudgement> judgements() const noexcept;  // d × n

 private:
  void upload(const Positions& at, int binding, Uploader& uploader);

  std::vector<Buffer> buffers_;  // by binding
  Buffer hostPositions_, hostOutcomes_, hostJudgements_;
  DescriptorSetLayoutHandle layout_;
  DescriptorPoolHandle pool_;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
};

}  // namespace ibr
