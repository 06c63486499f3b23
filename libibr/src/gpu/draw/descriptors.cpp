// SPDX-License-Identifier: Apache-2.0
#include "gpu/draw/descriptors.h"

#include "base/vulkan/functions.h"
#include "ibr/target.h"

namespace ibr {
namespace {

void writeImageInfo(const Device& device, VkDescriptorSet set, DescriptorSlot slot, VkDescriptorType type,
                    const VkDescriptorImageInfo& info) {
  VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
  write.dstSet = set;
  write.dstBinding = slot.binding;
  write.dstArrayElement = slot.element;
  write.descriptorCount = 1;
  write.descriptorType = type;
  write.pImageInfo = &info;
  vkUpdateDescriptorSets(device.handle(), 1, &write, 0, nullptr);
}

}  // namespace

DescriptorPoolHandle makeDescriptorPool(const Device& device, std::uint32_t sets,
                                        std::span<const VkDescriptorPoolSize> sizes) {
  VkDescriptorPoolCreateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  info.maxSets = sets;
  info.poolSizeCount = std::uint32_t(sizes.size());
  info.pPoolSizes = sizes.data();
  return make<DescriptorPoolHandle>(device, vkCreateDescriptorPool, info, "vkCreateDescriptorPool");
}

VkDescriptorSet allocateSet(const Device& device, VkDescriptorPool pool, VkDescriptorSetLayout layout) {
  VkDescriptorSetAllocateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  info.descriptorPool = pool;
  info.descriptorSetCount = 1;
  info.pSetLayouts = &layout;
  VkDescriptorSet set = VK_NULL_HANDLE;
  vk(vkAllocateDescriptorSets(device.handle(), &info, &set), "vkAllocateDescriptorSets");
  return set;
}

void writeStorageBuffer(const Device& device, VkDescriptorSet set, std::uint32_t binding, VkBuffer buffer) {
  const VkDescriptorBufferInfo info{buffer, 0, VK_WHOLE_SIZE};
  VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
  write.dstSet = set;
  write.dstBinding = binding;
  write.descriptorCount = 1;
  write.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
  write.pBufferInfo = &info;
  vkUpdateDescriptorSets(device.handle(), 1, &write, 0, nullptr);
}

void writeSampledImage(const Device& device, VkDescriptorSet set, std::uint32_t binding, VkSampler sampler,
                       VkImageView view) {
  writeImageInfo(device, set, {binding, 0}, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                 {sampler, view, use::kSampled.layout});
}

void writeStorageImage(const Device& device, VkDescriptorSet set, std::uint32_t binding, VkImageView view) {
  writeImageInfo(device, set, {binding, 0}, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
                 {VK_NULL_HANDLE, view, VK_IMAGE_LAYOUT_GENERAL});
}

void writeImage(const Device& device, VkDescriptorSet set, DescriptorSlot slot, VkImageView view) {
  writeImageInfo(device, set, slot, VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE, {VK_NULL_HANDLE, view, use::kSampled.layout});
}

void writeSampler(const Device& device, VkDescriptorSet set, DescriptorSlot slot, VkSampler sampler) {
  writeImageInfo(device, set, slot, VK_DESCRIPTOR_TYPE_SAMPLER, {sampler, VK_NULL_HANDLE, VK_IMAGE_LAYOUT_UNDEFINED});
}

}  // namespace ibr
