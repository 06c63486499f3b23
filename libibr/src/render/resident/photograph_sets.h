// SPDX-License-Identifier: Apache-2.0
// Descriptor sets of cells: four texture slots, so that members may be in different pages and no sampler is ever
// indexed.
//
// Cells whose members are in the same pages share a set. A set is never written while a frame may use it, so a change
// of pages means another set.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <map>
#include <vector>

#include "gpu/device/handle.h"
#include "ibr/device.h"
#include "ibr/gpu_scene.h"
#include "shared/cell.h"

namespace ibr {

/// Samples photographs as `filter` says; the row's ends follow `addressModeU`.
SamplerHandle makePhotographSampler(const Device& device, TextureFilter filter, VkSamplerAddressMode addressModeU);

class PhotographSets {
 public:
  PhotographSets(const Device& device, TextureFilter filter);

  struct Slot {
    VkImageView view = VK_NULL_HANDLE;
    bool wraps = false;  // from the right edge to the left, as a panorama does
    auto operator<=>(const Slot&) const = default;
  };
  using Slots = std::array<Slot, shader::kMaxMembers>;

  /// For use in this frame; 0: for as long as the pages last.
  VkDescriptorSet get(const Slots& slots, std::uint64_t frame, std::uint64_t completedFrame);

  /// The view goes; frames that used it have finished.
  void forget(VkImageView view);

  VkDescriptorSetLayout layout() const noexcept { return layout_.get(); }
  std::size_t count() const noexcept { return sets_.size(); }

 private:
  struct Set {
    VkDescriptorSet handle;
    std::uint64_t lastFrame;
  };
  VkDescriptorSet unusedSet();

  const Device* device_;
  SamplerHandle ends_, wraps_;
  DescriptorSetLayoutHandle layout_;
  std::vector<DescriptorPoolHandle> pools_;
  std::map<Slots, Set> sets_;
  std::vector<VkDescriptorSet> unused_;
};

}  // namespace ibr
