// SPDX-License-Identifier: Apache-2.0
// Descriptor sets that are written once, when their owner is made.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <span>

#include "base/vulkan/handle.h"
#include "ibr/device.h"

namespace ibr {

/// A pool for `sets` sets in total. The sets are freed with the pool.
DescriptorPoolHandle makeDescriptorPool(const Device& device, std::uint32_t sets,
                                        std::span<const VkDescriptorPoolSize> sizes);

VkDescriptorSet allocateSet(const Device& device, VkDescriptorPool pool, VkDescriptorSetLayout layout);

/// Writes the whole buffer. The device must not be using the set.
void writeStorageBuffer(const Device& device, VkDescriptorSet set, std::uint32_t binding, VkBuffer buffer);

/// Writes an image in use::kSampled.
void writeSampledImage(const Device& device, VkDescriptorSet set, std::uint32_t binding, VkSampler sampler,
                       VkImageView view);

/// Writes an image in VK_IMAGE_LAYOUT_GENERAL that shaders write to.
void writeStorageImage(const Device& device, VkDescriptorSet set, std::uint32_t binding, VkImageView view);

/// An element of an array of descriptors.
struct DescriptorSlot {
  std::uint32_t binding = 0, element = 0;
};
/// Writes an image in use::kSampled, without a sampler.
void writeImage(const Device& device, VkDescriptorSet set, DescriptorSlot slot, VkImageView view);
void writeSampler(const Device& device, VkDescriptorSet set, DescriptorSlot slot, VkSampler sampler);

}  // namespace ibr
