// SPDX-License-Identifier: Apache-2.0
// Reads back the layers of a program's swapchain images, on the program's own device and queue, between two frames of
// the program.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <vector>

namespace ibr::test {

class PictureTap {
 public:
  PictureTap() = default;
  PictureTap(VkPhysicalDevice physical, VkDevice device, std::uint32_t family, std::uint32_t queue);

  /// Reads pixels of four bytes from a layer of a colour image, which must be in the layout of released images and
  /// stays there. Nothing else may use the queue during the call. Empty if a Vulkan call fails.
  std::vector<std::uint8_t> read(VkImage image, std::uint32_t layer, VkRect2D rect) const;

 private:
  bool copy(VkImage image, std::uint32_t layer, VkRect2D rect, VkBuffer into) const;

  VkPhysicalDevice physical_ = VK_NULL_HANDLE;
  VkDevice device_ = VK_NULL_HANDLE;
  VkQueue queue_ = VK_NULL_HANDLE;
  std::uint32_t family_ = 0;
};

}  // namespace ibr::test
