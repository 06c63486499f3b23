// SPDX-License-Identifier: Apache-2.0
// Binds textures of the candidate photographs for the gather: 16 slots for arrays of photographs, 16 for arrays of
// depths. Shaders never index them dynamically.
//
// If all arrays of the scene fit into the slots, one descriptor set serves all frames. Otherwise, or if photographs are
// streamed, each frame has a set with its candidates' arrays in order. A set is never written while a frame may use the
// set.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "base/vulkan/handle.h"
#include "ibr/device.h"
#include "ibr/renderer.h"
#include "render/resident/scene_textures.h"
#include "render/resident/set_cache.h"
#include "shared/gather.h"

namespace ibr {

class GatherTextures {
 public:
  /// `nodes`: photographs that can be gathered from; at least one. Scene and textures must outlive this object.
  GatherTextures(const Device& device, TextureFilter filter, const Scene& scene, const SceneTextures& textures,
                 const std::vector<std::uint32_t>& nodes);

  struct TextureSlots {
    std::uint32_t slot = 0, layer = 0, depthSlot = 0, depthLayer = 0;
    double depthScale = 0;
  };
  /// Slots and layers of a photograph that has the index `candidate` in the last bound plan.
  TextureSlots place(std::size_t candidate, std::uint32_t node) const noexcept;

  /// True if bind() must be called for every frame.
  bool bindsFrames() const noexcept { return bindsFrames_; }
  /// Binds the textures of a plan's photographs for `frame`; no effect if one set serves all frames. Allocates nothing
  /// while fewer than kSetsPerPool frames are in flight; then throws Error{outOfMemory}.
  void bind(std::span<const PlannedPhotograph> photographs, std::uint64_t frame, std::uint64_t completedFrame);
  /// Drops descriptor sets that use the view, which is about to be destroyed. Frames that used it must have finished.
  void forget(VkImageView view);

  VkDescriptorSet set() const noexcept { return bound_; }
  VkDescriptorSetLayout layout() const noexcept { return layout_.get(); }
  std::uint32_t photographSlots() const noexcept { return photographSlots_; }  // that shaders distinguish
  std::uint32_t depthSlots() const noexcept { return depthSlots_; }
  bool isCubic() const noexcept { return isCubic_; }  // TextureFilter::bicubic

 private:
  static constexpr std::uint32_t kSetsPerPool = 64;

  struct Slots {
    std::array<VkImageView, shader::kMaxGathered> photographs{}, depths{};
    auto operator<=>(const Slots&) const = default;
  };
  VkDescriptorSet get(const Slots& slots, std::uint64_t frame, std::uint64_t completedFrame);
  void grow();

  const Device* device_;
  const SceneTextures* textures_;
  StreamItems items_;
  SamplerHandle ends_, wraps_;
  DescriptorSetLayoutHandle layout_;
  std::vector<DescriptorPoolHandle> pools_;
  SetCache<Slots> cache_;
  bool bindsFrames_ = false, isCubic_;
  std::uint32_t photographSlots_ = 1, depthSlots_ = 1;
  std::vector<std::uint32_t> slotOf_, depthSlotOf_;  // by node, if one set serves all frames
  std::vector<double> depthScales_;                  // by node: Node::depthScale
  VkDescriptorSet bound_ = VK_NULL_HANDLE;
};

}  // namespace ibr
