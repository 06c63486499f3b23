// SPDX-License-Identifier: Apache-2.0
// Submits work and waits for it.
#pragma once

#include <vulkan/vulkan_core.h>

#include <functional>

#include "base/vulkan/handle.h"
#include "ibr/device.h"

namespace ibr {

/// Holds Device::lockQueue() while it lives. Every use of a device's queue needs this lock, and so does
/// vkDeviceWaitIdle. Not recursive. The device must outlive the object.
class QueueLock {
 public:
  explicit QueueLock(const Device& device) : device_(device) { device.lockQueue(); }
  QueueLock(const QueueLock&) = delete;
  QueueLock& operator=(const QueueLock&) = delete;
  ~QueueLock() { device_.unlockQueue(); }

 private:
  const Device& device_;
};

/// Calls vkDeviceWaitIdle with the queue locked. Marks the device lost if the call reports VK_ERROR_DEVICE_LOST.
VkResult waitIdle(const Device& device);

/// A reusable command buffer. The device must outlive the object.
class Submission {
 public:
  explicit Submission(const Device& device);

  /// Calls `record`, submits to the device's queue and waits for the end. Throws the exceptions of `record` (nothing is
  /// submitted) and Error (deviceLost, outOfMemory); run() may be called again after either.
  void run(const std::function<void(VkCommandBuffer)>& record);

 private:
  const Device* device_;
  CommandPoolHandle pool_;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;  // allocated from pool_
  FenceHandle fence_;
};

/// As Submission::run, once.
void submitAndWait(const Device& device, const std::function<void(VkCommandBuffer)>& record);

}  // namespace ibr
