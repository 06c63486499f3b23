// SPDX-License-Identifier: Apache-2.0
#include "base/vulkan/pipeline_cache.h"

#include <catch2/catch.hpp>
#include <string>

#include "base/file.h"
#include "base/vulkan/functions.h"
#include "support/gpu.h"
#include "support/handmade_device.h"
#include "support/temporary_folder.h"
#include "test_picture.h"

using namespace ibr;
using Catch::Contains;
using Bytes = std::vector<std::byte>;

namespace {

constexpr std::size_t kHead = 16;  // bytes of the file before Vulkan's data

struct Logged {
  std::string debug, info, warnings;
};

/// Creates a device with a cache file, draws, and destroys the device.
Logged drawWith(const std::filesystem::path& file) {
  Logged logged;
  {
    const Device device = Device::create({.validation = true,
                                          .log =
                                              [&](LogLevel level, std::string_view text) {
                                                if (level == LogLevel::debug) logged.debug += text;
                                                if (level == LogLevel::info) logged.info += text;
                                                if (level >= LogLevel::warning) logged.warnings += text;
                                              },
                                          .pipelineCache = file});
    CHECK(device.pipelineCache() != VK_NULL_HANDLE);
    CHECK(test::samplePicture(device) == test::expectedPicture());
    CHECK(device.validationMessages() == 0);
  }
  return logged;
}

bool isWhole(const std::filesystem::path& file) {
  const Bytes bytes = readFile(file);
  return bytes.size() > kHead && bytes == packedPipelineCache(std::span(bytes).subspan(kHead));
}

}  // namespace

TEST_CASE("compiled pipelines are cached in a file for the next device") {
  const test::TemporaryFolder folder;
  const auto file = folder / "pipelines";
  const Logged first = drawWith(file), second = drawWith(file);
  CHECK_THAT(first.debug, !Contains(file.string()));
  CHECK_THAT(second.debug, Contains(file.string()));
  CHECK((first.warnings + second.warnings).empty());
  CHECK(isWhole(file));
  // Only the cache file remains.
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 1);
}

TEST_CASE("a damaged pipeline cache file is reported, ignored and replaced") {
  const test::TemporaryFolder folder;
  const auto file = folder / "pipelines";
  drawWith(file);
  const Bytes whole = readFile(file);
  std::vector<Bytes> broken{{}, Bytes(7), Bytes(kHead), Bytes(5000, std::byte(0x5A)), packedPipelineCache({})};
  for (const std::size_t left : {kHead - 1, kHead + 3, whole.size() - 1})
    broken.emplace_back(whole.begin(), whole.begin() + std::ptrdiff_t(left));
  for (const std::size_t at : {std::size_t(0), kHead - 1, kHead, whole.size() - 1}) {
    broken.push_back(whole);
    broken.back()[at] ^= std::byte(1);
  }
  broken.push_back(whole);
  broken.back().push_back(std::byte(0));
  for (const Bytes& bytes : broken) {
    writeFile(file, bytes);
    const Logged logged = drawWith(file);
    INFO(bytes.size() << " bytes");
    CHECK_THAT(logged.warnings, Contains(file.string()));
    CHECK_THAT(logged.debug, !Contains(file.string()));
    CHECK(isWhole(file));
  }
}

TEST_CASE("a pipeline cache of another device is ignored") {
  const test::TemporaryFolder folder;
  const auto file = folder / "pipelines";
  drawWith(file);
  const Bytes whole = readFile(file);
  // Bytes of the version, the vendor, the device, and the driver's identity.
  for (const std::size_t at : {4, 8, 12, 16, 31}) {
    Bytes data(whole.begin() + kHead, whole.end());
    data[at] ^= std::byte(1);
    writeFile(file, packedPipelineCache(data));
    const Logged logged = drawWith(file);
    INFO("byte " << at);
    CHECK_THAT(logged.info, Contains(file.string()));
    CHECK_THAT(logged.debug, !Contains(file.string()));
    CHECK(logged.warnings.empty());
    CHECK_THAT(drawWith(file).debug, Contains(file.string()));
  }
}

TEST_CASE("a pipeline cache file that cannot be written is reported") {
  const test::TemporaryFolder folder;
  CHECK_THAT(drawWith(folder / "none" / "pipelines").warnings, Contains((folder / "none").string()));
  CHECK_FALSE(std::filesystem::exists(folder / "none"));
  CHECK_THAT(drawWith(folder.path()).warnings, Contains(folder.path().string()));
  // An exception from the log callback during destruction of the device is ignored.
  const Device device = Device::create({.log =
                                            [](LogLevel level, std::string_view) {
                                              if (level == LogLevel::warning) throw 1;
                                            },
                                        .pipelineCache = folder / "none" / "pipelines"});
}

TEST_CASE("an adopted device uses the pipeline cache of its creator, or none") {
  const test::HandmadeDevice handmade;
  DeviceHandles handles = handmade.handles();
  CHECK(Device::adopt(handles).pipelineCache() == VK_NULL_HANDLE);
  const VkPipelineCacheCreateInfo info{.sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO};
  REQUIRE(vkCreatePipelineCache(handles.device, &info, nullptr, &handles.pipelineCache) == VK_SUCCESS);
  {
    const Device adopted = Device::adopt(handles);
    CHECK(adopted.pipelineCache() == handles.pipelineCache);
    CHECK(test::samplePicture(adopted) == test::expectedPicture());
  }
  vkDestroyPipelineCache(handles.device, handles.pipelineCache, nullptr);
}
