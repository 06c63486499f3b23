// SPDX-License-Identifier: Apache-2.0
// What a driver keeps of the pipelines it compiled, also from one run of a program to the next.
//
// The file: "ibrpipe1", 64 bits that check what follows (base/hash.h), and Vulkan's data, which says whose it is. A
// driver need not survive data that it did not write, so it never sees any other.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include "gpu/device/validation.h"

namespace ibr {

/// The file's bytes for Vulkan's data.
std::vector<std::byte> packedPipelineCache(std::span<const std::byte> data);

class PipelineCache {
 public:
  /// Begins with the file's data where there are such of this device and driver; what is not is ignored, and `messages`
  /// (which must outlive it, as must the device) told. An empty path: no file. Throws as vk().
  PipelineCache(VkDevice device, const VkPhysicalDeviceProperties& properties, std::filesystem::path file,
                Messages& messages);
  PipelineCache(const PipelineCache&) = delete;
  PipelineCache& operator=(const PipelineCache&) = delete;
  /// Writes the file, beside it first, where its data have changed. What fails is told.
  ~PipelineCache();

  VkPipelineCache get() const noexcept { return cache_; }

 private:
  void save() const;

  VkDevice device_;
  std::filesystem::path file_;
  Messages& messages_;
  std::vector<std::byte> read_;  // of the file
  VkPipelineCache cache_ = VK_NULL_HANDLE;
};

}  // namespace ibr
