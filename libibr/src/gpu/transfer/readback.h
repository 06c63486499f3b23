// SPDX-License-Identifier: Apache-2.0
// Reads buffers and images of the device back to the host. For tests and tools: each call submits and waits.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/vulkan/buffer.h"
#include "ibr/device.h"
#include "ibr/target.h"

namespace ibr {

/// Reads one level of one layer: rows from the top, no padding. `extent` is the level's or a corner of it. The image
/// needs VK_IMAGE_USAGE_TRANSFER_SRC_BIT; its use before and after the call is `current`.
std::vector<std::byte> readImage(const Device& device, VkImage image, VkExtent2D extent, std::uint32_t bytesPerPixel,
                                 ImageUse current, VkImageAspectFlags aspect = VK_IMAGE_ASPECT_COLOR_BIT,
                                 std::uint32_t layer = 0, std::uint32_t level = 0);

/// Reads the whole buffer after all submitted work. The buffer needs VK_BUFFER_USAGE_TRANSFER_SRC_BIT.
std::vector<std::byte> readBuffer(const Device& device, const Buffer& buffer);

}  // namespace ibr
