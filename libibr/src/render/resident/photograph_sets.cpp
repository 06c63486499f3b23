// SPDX-License-Identifier: Apache-2.0
#include "render/resident/photograph_sets.h"

#include <algorithm>

#include "base/vulkan/functions.h"
#include "base/vulkan/pipeline.h"
#include "gpu/draw/descriptors.h"

namespace ibr {
namespace {

constexpr std::uint32_t kSetsPerPool = 256;
constexpr std::size_t kMaxSets = 4096;  // above this number, sets of finished frames are reused

VkSamplerMipmapMode mipmapMode(const Device& device, TextureFilter filter) {
  const bool software = device.kind() == DeviceKind::software;
  const bool nearest = filter == TextureFilter::bilinear || (filter == TextureFilter::automatic && software);
  return nearest ? VK_SAMPLER_MIPMAP_MODE_NEAREST : VK_SAMPLER_MIPMAP_MODE_LINEAR;
}

DescriptorSetLayoutHandle makeLayout(const Device& device) {
  std::array<VkDescriptorSetLayoutBinding, shader::kMaxMembers> bindings{};
  for (std::uint32_t i = 0; i < bindings.size(); ++i)
    bindings[i] = {i, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, VK_SHADER_STAGE_FRAGMENT_BIT, nullptr};
  return makeSetLayout(device, bindings);
}

}  // namespace

SamplerHandle makePhotographSampler(const Device& device, TextureFilter filter, VkSamplerAddressMode addressModeU) {
  VkSamplerCreateInfo info{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
  info.magFilter = info.minFilter = VK_FILTER_LINEAR;
  info.mipmapMode = mipmapMode(device, filter);
  info.addressModeU = addressModeU;
  info.addressModeV = info.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  info.maxLod = VK_LOD_CLAMP_NONE;
  return make<SamplerHandle>(device, vkCreateSampler, info, "vkCreateSampler");
}

PhotographSets::PhotographSets(const Device& device, TextureFilter filter)
    : device_(&device),
      ends_(makePhotographSampler(device, filter, VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE)),
      wraps_(makePhotographSampler(device, filter, VK_SAMPLER_ADDRESS_MODE_REPEAT)),
      layout_(makeLayout(device)) {}

VkDescriptorSet PhotographSets::get(const Slots& slots, std::uint64_t frame, std::uint64_t completedFrame) {
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
  for (std::uint32_t i = 0; i < slots.size(); ++i)
    writeSampledImage(*device_, set, i, (slots[i].wraps ? wraps_ : ends_).get(), slots[i].view);
  sets_.emplace(slots, Set{set, frame});
  return set;
}

VkDescriptorSet PhotographSets::unusedSet() {
  if (unused_.empty()) {
    const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, kSetsPerPool * shader::kMaxMembers};
    pools_.push_back(makeDescriptorPool(*device_, kSetsPerPool, {&size, 1}));
    for (std::uint32_t i = 0; i < kSetsPerPool; ++i)
      unused_.push_back(allocateSet(*device_, pools_.back().get(), layout_.get()));
  }
  const VkDescriptorSet set = unused_.back();
  unused_.pop_back();
  return set;
}

void PhotographSets::forget(VkImageView view) {
  std::erase_if(sets_, [&](const auto& entry) {
    const bool gone = std::ranges::find(entry.first, view, &Slot::view) != entry.first.end();
    if (gone) unused_.push_back(entry.second.handle);
    return gone;
  });
}

}  // namespace ibr
