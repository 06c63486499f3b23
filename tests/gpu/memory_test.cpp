// SPDX-License-Identifier: Apache-2.0
// Out of memory: excessive requests, and failures of the N-th Vulkan call.
#include <catch2/catch.hpp>
#include <string>
#include <utility>

#include "base/vulkan/buffer.h"
#include "base/vulkan/gpu_image.h"
#include "base/vulkan/vulkan.h"
#include "ibr/error.h"
#include "support/gpu.h"
#include "support/vulkan_faults.h"
#include "test_picture.h"

using namespace ibr;
using Catch::Contains;
using test::failEachCall;
using test::testDevice;

TEST_CASE("a buffer that is too large is refused with its name and size, and the next buffer works") {
  const VkDeviceSize size = VkDeviceSize(1) << 50;
  const auto kind = GENERATE(MemoryKind::device, MemoryKind::upload, MemoryKind::readback);
  for (const VkDeviceSize wanted : {size, testDevice().memoryProperties().memoryHeaps[0].size + 1}) {
    try {
      const Buffer buffer(testDevice(), wanted, VK_BUFFER_USAGE_TRANSFER_DST_BIT, kind, "monster");
      FAIL("it was made");
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::outOfMemory);
      CHECK_THAT(error.what(), Contains("monster") && Contains("bytes"));
    }
  }
  const Buffer buffer(testDevice(), 64, VK_BUFFER_USAGE_TRANSFER_DST_BIT, kind, "modest");
  CHECK(buffer.get() != VK_NULL_HANDLE);
}

TEST_CASE("an image that is too large is refused, and the next image works", "[P10]") {
  const std::uint32_t side = testDevice().properties().limits.maxImageDimension2D;
  GpuImageInfo info{.format = VK_FORMAT_R32G32B32A32_SFLOAT,
                    .extent = {side, side},
                    .layers = 256,
                    .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT,
                    .viewType = VK_IMAGE_VIEW_TYPE_2D_ARRAY};
  try {
    const GpuImage image(testDevice(), info, "monster");
    FAIL("it was made");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::outOfMemory);
    CHECK_THAT(error.what(), Contains("monster") && Contains("bytes"));
  }
  info.extent = {16, 16};
  CHECK(GpuImage(testDevice(), info, "modest").get() != VK_NULL_HANDLE);
}

TEST_CASE("images beyond the device's limits are refused with the limit") {
  const VkPhysicalDeviceLimits& limits = testDevice().properties().limits;
  const auto refusal = [](GpuImageInfo info) -> std::string {
    try {
      GpuImage(testDevice(), info, "tested");
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::unsupported);
      return error.what();
    }
    FAIL("it was made");
    return {};
  };
  const GpuImageInfo good{.format = VK_FORMAT_R8_UNORM, .extent = {4, 4}, .usage = VK_IMAGE_USAGE_SAMPLED_BIT};
  GpuImageInfo info = good;
  info.layers = limits.maxImageArrayLayers + 1;
  CHECK_THAT(refusal(info), Contains("tested") && Contains("layers"));
  info = good;
  info.extent.width = limits.maxImageDimension2D + 1;
  CHECK_THAT(refusal(info),
             Contains("tested") && Contains("width") && Contains(std::to_string(limits.maxImageDimension2D)));
  info = good;
  info.mipLevels = 40;
  CHECK_THAT(refusal(info), Contains("tested") && Contains("40"));
  info = good;
  info.usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
  CHECK_THAT(refusal(info), Contains("VkFormat 9"));
}

TEST_CASE("any failing Vulkan call throws, leaks nothing and leaves the next image correct", "[P2][P10]") {
  const auto [result, code] = GENERATE(std::pair(VK_ERROR_OUT_OF_DEVICE_MEMORY, ErrorCode::outOfMemory),
                                       std::pair(VK_ERROR_OUT_OF_HOST_MEMORY, ErrorCode::outOfMemory),
                                       std::pair(VK_ERROR_UNKNOWN, ErrorCode::vulkan));  // loss: device_loss_test
  const Device device = Device::create({.validation = true, .log = test::testLog()});    // its destructor reports leaks
  Image8 picture;
  const int failures = failEachCall(result, code, [&] { picture = test::samplePicture(device); }).failures;
  CHECK(picture == test::expectedPicture());
  CHECK(failures > 40);  // otherwise the calls are not intercepted
}

TEST_CASE("any failing Vulkan call during device creation throws and leaks nothing", "[P10]") {
  const int failures = failEachCall(VK_ERROR_OUT_OF_HOST_MEMORY, ErrorCode::outOfMemory, [] {
                         Device::create({.validation = true, .log = test::testLog()});
                       }).failures;
  CHECK(failures > 2);
}

TEST_CASE("drivers that find no device give an empty device list") {
  // Fails the second call, which enumerates the devices.
  const auto fail = [] { test::failCall(1, VK_ERROR_INITIALIZATION_FAILED); };
  fail();
  CHECK(Device::list().empty());
  fail();
  CHECK_THROWS_WITH(Device::create(), Contains("usable") && Contains("mesa-vulkan-drivers"));
  test::failNothing();
}

TEST_CASE("each VkResult has an error code and a name") {
  const auto codeOf = [](VkResult result) {
    try {
      vk(result, "vkDoSomething");
    } catch (const Error& error) {
      CHECK_THAT(error.what(), Contains("vkDoSomething") && Contains(resultName(result)));
      return error.code();
    }
    FAIL("no error");
    return ErrorCode::io;
  };
  CHECK_NOTHROW(vk(VK_SUCCESS, "vkDoSomething"));
  CHECK(codeOf(VK_ERROR_OUT_OF_HOST_MEMORY) == ErrorCode::outOfMemory);
  CHECK(codeOf(VK_ERROR_OUT_OF_DEVICE_MEMORY) == ErrorCode::outOfMemory);
  CHECK(codeOf(VK_ERROR_DEVICE_LOST) == ErrorCode::deviceLost);
  CHECK(codeOf(VK_ERROR_EXTENSION_NOT_PRESENT) == ErrorCode::unsupported);
  CHECK(codeOf(VK_ERROR_UNKNOWN) == ErrorCode::vulkan);
  CHECK(std::string(resultName(VK_ERROR_DEVICE_LOST)) == "VK_ERROR_DEVICE_LOST");
  CHECK_THAT(resultName(VkResult(-987654)), Contains("VkResult"));
}
