// SPDX-License-Identifier: Apache-2.0
// Pipeline cache of a device, stored in a file between runs of a program.
//
// File: "ibrpipe1", a 64-bit hash of the rest (base/hash.h), and Vulkan's data, whose header names device and driver.
// Drivers may crash on foreign data, so a driver only gets data that it wrote.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include "base/vulkan/validation.h"

namespace ibr {

/// Returns the file's bytes for Vulkan's data.
std::vector<std::byte> packedPipelineCache(std::span<const std::byte> data);

class PipelineCache {
 public:
  /// Starts with the file's data if device and driver match; else reports to `messages`. Device and messages must
  /// outlive the cache. An empty path: no file. Throws as vk().
  PipelineCache(VkDevice device, const VkPhysicalDeviceProperties& properties, std::filesystem::path file,
                Messages& messages);
  PipelineCache(const PipelineCache&) = delete;
  PipelineCache& operator=(const PipelineCache&) = delete;
  /// Writes the file (to a draft, then renamed) if the data have changed. Failures are reported.
  ~PipelineCache();

  VkPipelineCache get() const noexcept { return cache_; }

 private:
  void save() const;

  VkDevice device_;
  std::filesystem::path file_;
  Messages& messages_;
  std::vector<std::byte> read_;  // contents of the file
  VkPipelineCache cache_ = VK_NULL_HANDLE;
};

}  // namespace ibr
