// SPDX-License-Identifier: Apache-2.0
#include "base/vulkan/pipeline_cache.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <utility>

#include "base/check.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/vulkan.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

constexpr std::array<char, 8> kMagic{'i', 'b', 'r', 'p', 'i', 'p', 'e', '1'};
constexpr std::size_t kHeaderBytes = kMagic.size() + sizeof(std::uint64_t);
constexpr std::uint64_t kMaxFileBytes = std::uint64_t(256) << 20;
static_assert(std::endian::native == std::endian::little);

// Reads Vulkan's data from a file. Throws Error if the file is damaged.
std::vector<std::byte> unpacked(const fs::path& file) {
  std::vector<std::byte> bytes = readFile(file, kMaxFileBytes);
  const std::vector<std::byte> data(bytes.begin() + std::ptrdiff_t(std::min(kHeaderBytes, bytes.size())), bytes.end());
  check(data.size() >= sizeof(VkPipelineCacheHeaderVersionOne) && bytes == packedPipelineCache(data),
        ErrorCode::invalidInput, "{}: not a valid pipeline cache", file.string());
  return data;
}

bool matchesDevice(const VkPhysicalDeviceProperties& properties, std::span<const std::byte> data) {
  VkPipelineCacheHeaderVersionOne header;
  std::memcpy(&header, data.data(), sizeof header);
  return header.headerVersion == VK_PIPELINE_CACHE_HEADER_VERSION_ONE && header.vendorID == properties.vendorID &&
         header.deviceID == properties.deviceID &&
         std::ranges::equal(header.pipelineCacheUUID, properties.pipelineCacheUUID);
}

// Returns an empty vector if no file suits the device and driver.
std::vector<std::byte> dataFor(const VkPhysicalDeviceProperties& properties, const fs::path& file, Messages& messages) {
  std::error_code ignored;
  if (file.empty() || !fs::exists(file, ignored)) return {};
  try {
    std::vector<std::byte> data = unpacked(file);
    if (matchesDevice(properties, data)) {
      messages.send(LogLevel::debug, fmt::format("{}: {} bytes of compiled pipelines", file.string(), data.size()));
      return data;
    }
    messages.send(LogLevel::info,
                  fmt::format("{}: pipeline cache of another device or driver, ignored", file.string()));
  } catch (const Error& error) {
    messages.send(LogLevel::warning, fmt::format("{}; ignored", error.what()));
  }
  return {};
}

}  // namespace

std::vector<std::byte> packedPipelineCache(std::span<const std::byte> data) {
  Hash hash;
  hash.add(data);
  const std::uint64_t value = hash.value();
  std::vector<std::byte> bytes(kHeaderBytes + data.size());
  std::memcpy(bytes.data(), kMagic.data(), kMagic.size());
  std::memcpy(bytes.data() + kMagic.size(), &value, sizeof value);
  std::ranges::copy(data, bytes.begin() + kHeaderBytes);
  return bytes;
}

PipelineCache::PipelineCache(VkDevice device, const VkPhysicalDeviceProperties& properties, fs::path file,
                             Messages& messages)
    : device_(device), file_(std::move(file)), messages_(messages), read_(dataFor(properties, file_, messages)) {
  const VkPipelineCacheCreateInfo info{.sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO,
                                       .initialDataSize = read_.size(),
                                       .pInitialData = read_.data()};
  vk(vkCreatePipelineCache(device_, &info, nullptr, &cache_), "vkCreatePipelineCache");
}

PipelineCache::~PipelineCache() {
  try {
    save();
  } catch (const std::exception& error) {
    try {
      messages_.send(LogLevel::warning, error.what());
    } catch (...) {
      // An exception of the caller's log must not end the program.
    }
  }
  vkDestroyPipelineCache(device_, cache_, nullptr);
}

void PipelineCache::save() const {
  if (file_.empty()) return;
  std::size_t size = 0;
  vk(vkGetPipelineCacheData(device_, cache_, &size, nullptr), "vkGetPipelineCacheData");
  std::vector<std::byte> data(size);
  vk(vkGetPipelineCacheData(device_, cache_, &size, data.data()), "vkGetPipelineCacheData");
  data.resize(size);
  if (data != read_) writeFile(file_, packedPipelineCache(data));
}

}  // namespace ibr
