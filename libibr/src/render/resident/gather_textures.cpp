// SPDX-License-Identifier: Apache-2.0
#include "render/resident/gather_textures.h"

#include <algorithm>
#include <utility>

#include "base/vulkan/pipeline.h"
#include "gpu/draw/descriptors.h"
#include "render/resident/photograph_sets.h"

namespace ibr {
namespace {

constexpr std::uint32_t kSlots = shader::kMaxGathered;

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

GatherTextures::GatherTextures(const Device& device, TextureFilter filter, const Scene& scene,
                               const SceneTextures& textures, const std::vector<std::uint32_t>& nodes)
    : device_(&device),
      textures_(&textures),
      items_(scene),
      ends_(makePhotographSampler(device, filter, VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE)),
      wraps_(makePhotographSampler(device, filter, VK_SAMPLER_ADDRESS_MODE_REPEAT)),
      layout_(makeLayout(device)),
      isCubic_(filter == TextureFilter::bicubic) {
  std::vector<VkImageView> views, depthViews;
  const std::uint32_t most = *std::ranges::max_element(nodes);
  slotOf_.resize(most + 1);
  depthSlotOf_.resize(most + 1);
  depthScales_.resize(most + 1);
  for (const std::uint32_t node : nodes) {
    slotOf_[node] = slotOf(views, textures.at(node).view);
    depthSlotOf_[node] = slotOf(depthViews, textures.at(items_.depth(node)).view);
    depthScales_[node] = scene.nodes[node].depthScale;
  }
  bindsFrames_ = textures.streams() || views.size() > kSlots || depthViews.size() > kSlots;
  photographSlots_ = bindsFrames_ ? kSlots : std::uint32_t(views.size());
  depthSlots_ = bindsFrames_ ? kSlots : std::uint32_t(depthViews.size());
  Slots slots;
  fillSlots(views, slots.photographs);
  fillSlots(depthViews, slots.depths);
  bound_ = get(slots, 0, 0);
}

GatherTextures::TextureSlots GatherTextures::place(std::size_t candidate, std::uint32_t node) const noexcept {
  const auto frameSlot = std::uint32_t(candidate);
  return {.slot = bindsFrames_ ? frameSlot : slotOf_[node],
          .layer = textures_->at(node).layer,
          .depthSlot = bindsFrames_ ? frameSlot : depthSlotOf_[node],
          .depthLayer = textures_->at(items_.depth(node)).layer,
          .depthScale = depthScales_[node]};
}

void GatherTextures::bind(std::span<const PlannedPhotograph> photographs, std::uint64_t frame,
                          std::uint64_t completedFrame) {
  if (!bindsFrames_ || photographs.empty()) return;
  Slots slots;
  for (std::size_t s = 0; s < kSlots; ++s) {
    const std::uint32_t node = photographs[s < photographs.size() ? s : 0].node;
    slots.photographs[s] = textures_->at(node).view;
    slots.depths[s] = textures_->at(items_.depth(node)).view;
  }
  bound_ = get(slots, frame, completedFrame);
}

VkDescriptorSet GatherTextures::get(const Slots& slots, std::uint64_t frame, std::uint64_t completedFrame) {
  if (const VkDescriptorSet set = cache_.find(slots, frame)) return set;
  VkDescriptorSet set = cache_.add(slots, frame, completedFrame);
  if (!set) {
    grow();
    set = cache_.add(slots, frame, completedFrame);
  }
  for (std::uint32_t s = 0; s < kSlots; ++s) {
    writeImage(*device_, set, {shader::kBindingGatherPhotographs, s}, slots.photographs[s]);
    writeImage(*device_, set, {shader::kBindingGatherDepths, s}, slots.depths[s]);
  }
  writeSampler(*device_, set, {shader::kBindingGatherSamplers, 0}, ends_.get());
  writeSampler(*device_, set, {shader::kBindingGatherSamplers, 1}, wraps_.get());
  return set;
}

void GatherTextures::grow() {
  const std::uint32_t sets = bindsFrames_ ? kSetsPerPool : 1;
  const std::array<VkDescriptorPoolSize, 2> sizes{
      {{VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE, sets * 2 * kSlots}, {VK_DESCRIPTOR_TYPE_SAMPLER, sets * 2}}};
  DescriptorPoolHandle pool = makeDescriptorPool(*device_, sets, sizes);
  std::vector<VkDescriptorSet> made;
  for (std::uint32_t i = 0; i < sets; ++i) made.push_back(allocateSet(*device_, pool.get(), layout_.get()));
  pools_.push_back(std::move(pool));
  cache_.grow(made);
}

void GatherTextures::forget(VkImageView view) {
  cache_.forget([&](const Slots& slots) {
    return std::ranges::find(slots.photographs, view) != slots.photographs.end() ||
           std::ranges::find(slots.depths, view) != slots.depths.end();
  });
}

}  // namespace ibr
