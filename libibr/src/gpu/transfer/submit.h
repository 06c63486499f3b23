// SPDX-License-Identifier: Apache-2.0
// Work that is submitted and waited for at once.
#pragma once

#include <vulkan/vulkan_core.h>

#include <functional>
#include <mutex>

#include "gpu/device/handle.h"
#include "ibr/device.h"

namespace ibr {

/// Around every use of a device's queue: holds its Device::queueMutex() while what it returns lives, where there is
/// one.
[[nodiscard]] std::unique_lock<std::mutex> holdQueue(std::mutex* queueMutex);

/// vkDeviceWaitIdle, which uses the queue. A device that is found lost is so from then on (Device::isLost).
VkResult waitIdle(const Device& device);

/// A command buffer that is used again and again. The device must outlive it.
class Submission {
 public:
  explicit Submission(const Device& device);

  /// Records by calling `record`, submits on the device's queue and waits until it is done. Throws what `record`
  /// throws (then nothing is submitted) and Error (deviceLost, outOfMemory); it may be run again after either.
  void run(const std::function<void(VkCommandBuffer)>& record);

 private:
  const Device* device_;
  CommandPoolHandle pool_;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;  // the pool's
  FenceHandle fence_;
};

/// The same, once.
void submitAndWait(const Device& device, const std::function<void(VkCommandBuffer)>& record);

}  // namespace ibr
