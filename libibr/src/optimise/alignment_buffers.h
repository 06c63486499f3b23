// SPDX-License-Identifier: Apache-2.0
// A mesh to be aligned and its pictures in device memory, with the set that the passes bind (shared/alignment.h).
#pragma once

#include <span>
#include <vector>

#include "gpu/device/handle.h"
#include "gpu/transfer/buffer.h"
#include "optimise/star_mesh.h"
#include "optimise/texels.h"
#include "shared/alignment.h"

namespace ibr {

class AlignmentBuffers {
 public:
  /// Uploads all but the positions; `starts` are those before the first cycle. Throws Error: unsupported where the
  /// device does not count in 64 bits or the pictures do not fit into one buffer; outOfMemory, deviceLost.
  AlignmentBuffers(const Device& device, const StarMesh& mesh, std::span<const Texels> pictures,
                   const Positions& starts);

  VkDescriptorSetLayout layout() const noexcept { return layout_.get(); }
  VkDescriptorSet set() const noexcept { return set_; }

  void upload(const Device& device, const Positions& at) { upload(device, at, shader::kBindingPositions); }

  /// Copies to the host what the passes recorded before have written; ends in use::kHostRead.
  void recordPositionReadback(VkCommandBuffer commands) const noexcept;
  void recordOutcomeReadback(VkCommandBuffer commands, std::uint32_t first, std::uint32_t count) const noexcept;
  void recordJudgementReadback(VkCommandBuffer commands) const noexcept;

  /// What was read back last.
  std::span<const glm::ivec2> positions() const noexcept;                   // d × n
  std::span<const shader::AlignmentOutcome> outcomes() const noexcept;      // d × points that move
  std::span<const shader::AlignmentJudgement> judgements() const noexcept;  // d × n

 private:
  void upload(const Device& device, const Positions& at, int binding);

  std::vector<Buffer> buffers_;  // at their bindings
  Buffer hostPositions_, hostOutcomes_, hostJudgements_;
  DescriptorSetLayoutHandle layout_;
  DescriptorPoolHandle pool_;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
};

}  // namespace ibr
