// SPDX-License-Identifier: Apache-2.0
// Memory that is not there: by asking for too much, and by letting the N-th call of Vulkan fail.
#include <dlfcn.h>

#include <catch2/catch.hpp>
#include <string>
#include <utility>

#include "gpu/buffer.h"
#include "gpu/gpu_image.h"
#include "gpu/vulkan.h"
#include "ibr/error.h"
#include "support/gpu.h"
#include "test_picture.h"

using namespace ibr;
using Catch::Matchers::Contains;
using test::testDevice;

namespace {

int callsUntilFailure = -1;  // negative: none fails
VkResult failure = VK_ERROR_OUT_OF_DEVICE_MEMORY;

bool failsNow() {
  return callsUntilFailure >= 0 && callsUntilFailure-- == 0;
}

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

}  // namespace

// The library is linked with these instead of the loader's; each hands on to the loader unless it is its turn to fail.
#define IBR_MAY_FAIL(name, parameters, arguments)             \
  extern "C" VKAPI_ATTR VkResult VKAPI_CALL name parameters { \
    static const auto real = next<PFN_##name>(#name);         \
    return failsNow() ? failure : real arguments;             \
  }
#define IBR_CREATE_MAY_FAIL(name, Info, Object)                                                                    \
  IBR_MAY_FAIL(name, (VkDevice device, const Info* info, const VkAllocationCallbacks* allocation, Object* object), \
               (device, info, allocation, object))

IBR_CREATE_MAY_FAIL(vkAllocateMemory, VkMemoryAllocateInfo, VkDeviceMemory)
IBR_CREATE_MAY_FAIL(vkCreateBuffer, VkBufferCreateInfo, VkBuffer)
IBR_CREATE_MAY_FAIL(vkCreateCommandPool, VkCommandPoolCreateInfo, VkCommandPool)
IBR_CREATE_MAY_FAIL(vkCreateDescriptorPool, VkDescriptorPoolCreateInfo, VkDescriptorPool)
IBR_CREATE_MAY_FAIL(vkCreateDescriptorSetLayout, VkDescriptorSetLayoutCreateInfo, VkDescriptorSetLayout)
IBR_CREATE_MAY_FAIL(vkCreateFence, VkFenceCreateInfo, VkFence)
IBR_CREATE_MAY_FAIL(vkCreateFramebuffer, VkFramebufferCreateInfo, VkFramebuffer)
IBR_CREATE_MAY_FAIL(vkCreateImage, VkImageCreateInfo, VkImage)
IBR_CREATE_MAY_FAIL(vkCreateImageView, VkImageViewCreateInfo, VkImageView)
IBR_CREATE_MAY_FAIL(vkCreatePipelineLayout, VkPipelineLayoutCreateInfo, VkPipelineLayout)
IBR_CREATE_MAY_FAIL(vkCreateRenderPass, VkRenderPassCreateInfo, VkRenderPass)
IBR_CREATE_MAY_FAIL(vkCreateSampler, VkSamplerCreateInfo, VkSampler)
IBR_CREATE_MAY_FAIL(vkCreateShaderModule, VkShaderModuleCreateInfo, VkShaderModule)
IBR_MAY_FAIL(vkAllocateCommandBuffers,
             (VkDevice device, const VkCommandBufferAllocateInfo* info, VkCommandBuffer* commands),
             (device, info, commands))
IBR_MAY_FAIL(vkAllocateDescriptorSets,
             (VkDevice device, const VkDescriptorSetAllocateInfo* info, VkDescriptorSet* sets), (device, info, sets))
IBR_MAY_FAIL(vkBeginCommandBuffer, (VkCommandBuffer commands, const VkCommandBufferBeginInfo* info), (commands, info))
IBR_MAY_FAIL(vkBindBufferMemory, (VkDevice device, VkBuffer buffer, VkDeviceMemory memory, VkDeviceSize offset),
             (device, buffer, memory, offset))
IBR_MAY_FAIL(vkBindImageMemory, (VkDevice device, VkImage image, VkDeviceMemory memory, VkDeviceSize offset),
             (device, image, memory, offset))
IBR_MAY_FAIL(vkCreateDevice,
             (VkPhysicalDevice physical, const VkDeviceCreateInfo* info, const VkAllocationCallbacks* allocation,
              VkDevice* device),
             (physical, info, allocation, device))
IBR_MAY_FAIL(vkCreateGraphicsPipelines,
             (VkDevice device, VkPipelineCache cache, std::uint32_t count, const VkGraphicsPipelineCreateInfo* infos,
              const VkAllocationCallbacks* allocation, VkPipeline* pipelines),
             (device, cache, count, infos, allocation, pipelines))
IBR_MAY_FAIL(vkCreateInstance,
             (const VkInstanceCreateInfo* info, const VkAllocationCallbacks* allocation, VkInstance* instance),
             (info, allocation, instance))
IBR_MAY_FAIL(vkEndCommandBuffer, (VkCommandBuffer commands), (commands))
IBR_MAY_FAIL(vkEnumeratePhysicalDevices, (VkInstance instance, std::uint32_t* count, VkPhysicalDevice* devices),
             (instance, count, devices))
IBR_MAY_FAIL(vkMapMemory,
             (VkDevice device, VkDeviceMemory memory, VkDeviceSize offset, VkDeviceSize size, VkMemoryMapFlags flags,
              void** data),
             (device, memory, offset, size, flags, data))
IBR_MAY_FAIL(vkQueueSubmit2, (VkQueue queue, std::uint32_t count, const VkSubmitInfo2* infos, VkFence fence),
             (queue, count, infos, fence))
IBR_MAY_FAIL(vkResetCommandPool, (VkDevice device, VkCommandPool pool, VkCommandPoolResetFlags flags),
             (device, pool, flags))
IBR_MAY_FAIL(vkResetFences, (VkDevice device, std::uint32_t count, const VkFence* fences), (device, count, fences))
IBR_MAY_FAIL(vkWaitForFences,
             (VkDevice device, std::uint32_t count, const VkFence* fences, VkBool32 all, std::uint64_t timeout),
             (device, count, fences, all, timeout))

namespace {

/// Calls with the 1st, 2nd, … call of Vulkan failing with `result`, until it succeeds; returns the number of failures.
/// Each must be an Error{code}, after which everything works.
template <class Call>
int failEachCall(VkResult result, ErrorCode code, Call call) {
  failure = result;
  for (int n = 0;; ++n) {
    callsUntilFailure = n;
    bool failed = false;
    try {
      call();
    } catch (const Error& error) {
      failed = true;
      INFO("call " << n << ": " << error.what());
      CHECK(error.code() == code);
    }
    const bool reached = callsUntilFailure < 0;
    callsUntilFailure = -1;
    if (!reached) return n;
    INFO("call " << n);
    CHECK(failed);
  }
}

}  // namespace

TEST_CASE("a buffer that is too large is refused with its name and size, and the next works", "[P10]") {
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

TEST_CASE("an image that is too large is refused, and the next works", "[P10]") {
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
  CHECK_THAT(refusal(info), Contains("tested: layers"));
  info = good;
  info.extent.width = limits.maxImageDimension2D + 1;
  CHECK_THAT(refusal(info), Contains("tested: width") && Contains(std::to_string(limits.maxImageDimension2D)));
  info = good;
  info.mipLevels = 40;
  CHECK_THAT(refusal(info), Contains("tested: mip levels 40"));
  info = good;
  info.usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
  CHECK_THAT(refusal(info), Contains("VkFormat 9"));
}

TEST_CASE("whichever call fails, it is an error, nothing leaks and the next picture is right", "[P2][P10]") {
  const auto [result, code] = GENERATE(std::pair(VK_ERROR_OUT_OF_DEVICE_MEMORY, ErrorCode::outOfMemory),
                                       std::pair(VK_ERROR_OUT_OF_HOST_MEMORY, ErrorCode::outOfMemory),
                                       std::pair(VK_ERROR_DEVICE_LOST, ErrorCode::deviceLost));
  const Device device = Device::create({.validation = true, .log = test::testLog()});  // its end tells of leaks
  Image8 picture;
  const int failures = failEachCall(result, code, [&] { picture = test::samplePicture(device); });
  CHECK(picture == test::expectedPicture());
  CHECK(failures > 40);  // or the calls are not ours
}

TEST_CASE("whichever call fails, a device is made whole or not at all", "[P10]") {
  const int failures = failEachCall(VK_ERROR_OUT_OF_HOST_MEMORY, ErrorCode::outOfMemory,
                                    [] { Device::create({.validation = true, .log = test::testLog()}); });
  CHECK(failures > 2);
}

TEST_CASE("drivers that find no device are no fault of the list's") {
  failure = VK_ERROR_INITIALIZATION_FAILED;  // of the second call, which asks for the devices
  callsUntilFailure = 1;
  CHECK(Device::list().empty());
  callsUntilFailure = 1;
  CHECK_THROWS_WITH(Device::create(), Contains("find none") && Contains("mesa-vulkan-drivers"));
  callsUntilFailure = -1;
}

TEST_CASE("results are sorted into codes, and named") {
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
  CHECK(std::string(resultName(VkResult(-987654))) == "an unknown VkResult");
}
