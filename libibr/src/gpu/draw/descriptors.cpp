// SPDX-License-Identifier: Apache-2.0
#include "gpu/draw/descriptors.h"

#include "ibr/target.h"

namespace ibr {

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
  const VkDescriptorImageInfo info{sampler, view, use::kSampled.layout};
  VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
  write.dstSet = set;
  write.dstBinding = binding;
  write.descriptorCount = 1;
  write.descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
  write.pImageInfo = &info;
  vkUpdateDescriptorSets(device.handle(), 1, &write, 0, nullptr);
}

}  // namespace ibr
