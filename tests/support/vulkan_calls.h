// SPDX-License-Identifier: Apache-2.0
// Counts libibr's Vulkan calls that allocate memory or use a queue, in a program linked with vulkan_calls.cpp. Not
// together with vulkan_faults.cpp, which replaces some of the same functions.
#pragma once

namespace ibr::test {

/// Numbers of calls by all threads since the program's start.
struct VulkanCalls {
  int allocations = 0, frees = 0;  // vkAllocateMemory, vkFreeMemory of non-null memory
  int submissions = 0;             // vkQueueSubmit, vkQueueSubmit2
  int waits = 0;                   // vkWaitForFences, vkQueueWaitIdle, vkDeviceWaitIdle

  int queueUses() const { return submissions + waits; }
  friend VulkanCalls operator-(const VulkanCalls& a, const VulkanCalls& b) {
    return {a.allocations - b.allocations, a.frees - b.frees, a.submissions - b.submissions, a.waits - b.waits};
  }
};

VulkanCalls vulkanCalls();

}  // namespace ibr::test
