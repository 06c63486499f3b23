// SPDX-License-Identifier: Apache-2.0
// Descriptor sets of cells: four texture slots, so that members may be in different texture arrays and no shader
// indexes samplers.
//
// Cells whose members are in the same texture arrays share a set. A set is never written while a frame may use the set;
// members in other arrays need another set.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <vector>

#include "base/vulkan/handle.h"
#include "ibr/device.h"
#include "ibr/gpu_scene.h"
#include "render/resident/set_cache.h"
#include "shared/cell.h"

namespace ibr {

inline constexpr std::uint32_t kFramesInFlight = 4;  // for which descriptor sets are allocated in advance

/// Returns a sampler for photographs with this filter. `addressModeU`: horizontal addressing.
SamplerHandle makePhotographSampler(const Device& device, TextureFilter filter, VkSamplerAddressMode addressModeU);

class PhotographSets {
 public:
  PhotographSets(const Device& device, TextureFilter filter);

  struct Slot {
    VkImageView view = VK_NULL_HANDLE;
    bool wraps = false;  // from the right edge to the left, for panoramas
    auto operator<=>(const Slot&) const = default;
  };
  using Slots = std::array<Slot, shader::kMaxMembers>;

  /// Allocates the sets of streamed scenes: of frames that use up to `setsPerFrame` different ones.
  void reserve(std::size_t setsPerFrame);

  /// Returns the set of these slots for use in `frame`; 0: for as long as the texture arrays exist. Allocates for frame
  /// 0, and where more than kFramesInFlight frames are in flight; then throws Error{outOfMemory}.
  VkDescriptorSet get(const Slots& slots, std::uint64_t frame, std::uint64_t completedFrame);

  /// Drops sets that use the view, which is about to be destroyed. Frames that used it must have finished.
  void forget(VkImageView view);

  VkDescriptorSetLayout layout() const noexcept { return layout_.get(); }
  std::size_t count() const noexcept { return cache_.count(); }

 private:
  void grow(std::uint32_t sets);

  const Device* device_;
  SamplerHandle ends_, wraps_;
  DescriptorSetLayoutHandle layout_;
  std::vector<DescriptorPoolHandle> pools_;
  SetCache<Slots> cache_;
};

}  // namespace ibr
