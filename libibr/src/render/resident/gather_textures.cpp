// SPDX-License-Identifier: Apache-2.0
#include "render/resident/gather_textures.h"

#include <algorithm>

#include "base/vulkan/pipeline.h"
#include "gpu/draw/descriptors.h"
#include "render/resident/photograph_sets.h"

namespace ibr {
namespace {

constexpr std::uint32_t kSlots = shader::kMaxGathered;
constexpr std::uint32_t kSetsPerPool = 64;
constexpr std::size_t kMaxSets = 1024;  // above this number, sets of finished frames are reused

DescriptorSetLayoutHandle makeLayout(const Device& device) {
  constexpr VkShaderStageFlags kStage = VK_SHADER_STAGE_FRAGMENT_BIT;
  const std::array<VkDescriptorSetLayoutBinding, 3> bindings{{
      {shader::kBindingGatherPhotographs, VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE, kSlots, kStage, nullptr},
      {shader::kBindingGatherDepths, VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE, kSlots, kStage, nullptr},
      {shader::kBindingGatherSamplers, VK_DESCRIPTOR_TYPE_SAMPLER, 2, kStage, nullptr},
  }};
  return makeSetLayout(device, bindings);
}

// Returns the index of a view in the list; appends the view if it is missing.
std::uint32_t slotOf(std::vector<VkImageView>& views, VkImageView view) {
  const auto found = std::ranges::find(views, view);
  const auto slot = std::uint32_t(found - views.begin());
  if (found == views.end()) views.push_back(view);
  return slot;
}

// Slots that shaders never read repeat the first view, since a binding must be valid.
void fillSlots(std::span<const VkImageView> views, std::array<VkImageView, kSlots>& slots) {
  for (std::size_t s = 0; s < slots.size(); ++s) slots[s] = s < views.size() ? views[s] : views[0];
}

}  // namespace

GatherTextures::GatherTextures(const Device& device, TextureFilter filter, const Photographs& photographs,
                               const DepthTextures& depths, const std::vector<std::uint32_t>& nodes)
    : device_(&device),
      photographs_(&photographs),
      depths_(&depths),
      ends_(makePhotographSampler(device, filter, VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE)),
      wraps_(makePhotographSampler(device, filter, VK_SAMPLER_ADDRESS_MODE_REPEAT)),
      layout_(makeLayout(device)),
      isCubic_(filter == TextureFilter::bicubic) {
  std::vector<VkImageView> views, depthViews;
  const std::uint32_t most = *std::ranges::max_element(nodes);
  slotOf_.resize(most + 1);
  depthSlotOf_.resize(most + 1);
  for (const std::uint32_t node : nodes) {
    slotOf_[node] = slotOf(views, photographs.at(node).view);
    depthSlotOf_[node] = slotOf(depthViews, depths.at(node).view);
  }
  bindsFrames_ = photographs.streams() || views.size() > kSlots || depthViews.size() > kSlots;
  photographSlots_ = bindsFrames_ ? kSlots : std::uint32_t(views.size());
  depthSlots_ = bindsFrames_ ? kSlots : std::uint32_t(depthViews.size());
  Slots slots;
  fillSlots(views, slots.photographs);
  fillSlots(depthViews, slots.depths);
  bound_ = get(slots, 0, 0);
}

GatherTextures::TextureSlots GatherTextures::place(std::size_t candidate, std::uint32_t node) const noexcept {
  const auto frameSlot = std::uint32_t(candidate);
  const DepthTextures::Sampled& depth = depths_->at(node);
  return {.slot = bindsFrames_ ? frameSlot : slotOf_[node],
          .layer = photographs_->at(node).layer,
          .depthSlot = bindsFrames_ ? frameSlot : depthSlotOf_[node],
          .depthLayer = depth.layer,
          .depthScale = depth.scale};
}

void GatherTextures::bind(std::span<const PlannedPhotograph> photographs, std::uint64_t frame,
                          std::uint64_t completedFrame) {
  if (!bindsFrames_ || photographs.empty()) return;
  std::vector<VkImageView> views, depthViews;
  for (const PlannedPhotograph& photograph : photographs) {
    views.push_back(photographs_->at(photograph.node).view);
    depthViews.push_back(depths_->at(photograph.node).view);
  }
  Slots slots;
  fillSlots(views, slots.photographs);
  fillSlots(depthViews, slots.depths);
  bound_ = get(slots, frame, completedFrame);
}

VkDescriptorSet GatherTextures::get(const Slots& slots, std::uint64_t frame, std::uint64_t completedFrame) {
  const auto found = sets_.find(slots);
  if (found != sets_.end()) {
    found->second.lastFrame = frame;
    return found->second.handle;
  }
  if (sets_.size() >= kMaxSets && frame > 0)
    std::erase_if(sets_, [&](const auto& entry) {
      const bool idle = entry.second.lastFrame <= completedFrame;
      if (idle) unused_.push_back(entry.second.handle);
      return idle;
    });
  const VkDescriptorSet set = unusedSet();
  for (std::uint32_t s = 0; s < kSlots; ++s) {
    writeImage(*device_, set, {shader::kBindingGatherPhotographs, s}, slots.photographs[s]);
    writeImage(*device_, set, {shader::kBindingGatherDepths, s}, slots.depths[s]);
  }
  writeSampler(*device_, set, {shader::kBindingGatherSamplers, 0}, ends_.get());
  writeSampler(*device_, set, {shader::kBindingGatherSamplers, 1}, wraps_.get());
  sets_.emplace(slots, Set{set, frame});
  return set;
}

VkDescriptorSet GatherTextures::unusedSet() {
  if (unused_.empty()) {
    const std::array<VkDescriptorPoolSize, 2> sizes{{{VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE, kSetsPerPool * 2 * kSlots},
                                                     {VK_DESCRIPTOR_TYPE_SAMPLER, kSetsPerPool * 2}}};
    pools_.push_back(makeDescriptorPool(*device_, kSetsPerPool, sizes));
    for (std::uint32_t i = 0; i < kSetsPerPool; ++i)
      unused_.push_back(allocateSet(*device_, pools_.back().get(), layout_.get()));
  }
  const VkDescriptorSet set = unused_.back();
  unused_.pop_back();
  return set;
}

void GatherTextures::forget(VkImageView view) {
  std::erase_if(sets_, [&](const auto& entry) {
    const bool gone = std::ranges::find(entry.first.photographs, view) != entry.first.photographs.end();
    if (gone) unused_.push_back(entry.second.handle);
    return gone;
  });
}

}  // namespace ibr
