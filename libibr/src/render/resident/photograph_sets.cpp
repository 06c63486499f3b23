// SPDX-License-Identifier: Apache-2.0
#include "render/resident/photograph_sets.h"

#include <algorithm>
#include <utility>

#include "base/vulkan/functions.h"
#include "base/vulkan/pipeline.h"
#include "gpu/draw/descriptors.h"

namespace ibr {
namespace {

constexpr std::uint32_t kSetsPerPool = 64;

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

void PhotographSets::reserve(std::size_t setsPerFrame) {
  if (setsPerFrame > 0) grow(std::uint32_t(setsPerFrame) * kFramesInFlight);  // a scene may have no cells
}

VkDescriptorSet PhotographSets::get(const Slots& slots, std::uint64_t frame, std::uint64_t completedFrame) {
  if (const VkDescriptorSet set = cache_.find(slots, frame)) return set;
  VkDescriptorSet set = cache_.add(slots, frame, completedFrame);
  if (!set) {
    grow(kSetsPerPool);
    set = cache_.add(slots, frame, completedFrame);
  }
  for (std::uint32_t i = 0; i < slots.size(); ++i)
    writeSampledImage(*device_, set, i, (slots[i].wraps ? wraps_ : ends_).get(), slots[i].view);
  return set;
}

void PhotographSets::grow(std::uint32_t sets) {
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, sets * shader::kMaxMembers};
  DescriptorPoolHandle pool = makeDescriptorPool(*device_, sets, {&size, 1});
  std::vector<VkDescriptorSet> made;
  for (std::uint32_t i = 0; i < sets; ++i) made.push_back(allocateSet(*device_, pool.get(), layout_.get()));
  pools_.push_back(std::move(pool));
  cache_.grow(made);
}

void PhotographSets::forget(VkImageView view) {
  cache_.forget([&](const Slots& slots) { return std::ranges::find(slots, view, &Slot::view) != slots.end(); });
}

}  // namespace ibr
