// SPDX-License-Identifier: Apache-2.0
// A machine without the Vulkan loader: this program's dlopen cannot open it.
#include <dlfcn.h>

#include <catch2/catch.hpp>
#include <string_view>

#include "ibr/device.h"
#include "support/error_of.h"

using namespace ibr;
using Catch::Contains;
using test::errorOf;

extern "C" void* dlopen(const char* file, int mode) noexcept {
  if (file && std::string_view(file) == "libvulkan.so.1") return nullptr;
  return reinterpret_cast<void* (*)(const char*, int)>(::dlsym(RTLD_NEXT, "dlopen"))(file, mode);
}

TEST_CASE("without the Vulkan loader the message names it, and the device list is empty") {
  for (int i = 0; i < 2; ++i) {  // a failure is not cached
    const Error error = errorOf([] { Device::create(); });
    CHECK(error.code() == ErrorCode::unsupported);
    CHECK_THAT(error.what(), Contains("libvulkan.so.1") && Contains("libvulkan1"));
    CHECK(Device::list().empty());
    CHECK_FALSE(Device::preferred());
  }
}

TEST_CASE("without the Vulkan loader no device can be described or adopted") {
  int some = 0;
  const auto handle = [&](auto null) { return reinterpret_cast<decltype(null)>(&some); };
  CHECK(errorOf([] { Device::describe(VK_NULL_HANDLE); }).code() == ErrorCode::unsupported);
  CHECK(errorOf([] { Device::featuresFor(VK_NULL_HANDLE); }).code() == ErrorCode::unsupported);
  const DeviceHandles handles{.instance = handle(VkInstance()),
                              .physicalDevice = handle(VkPhysicalDevice()),
                              .device = handle(VkDevice()),
                              .queue = handle(VkQueue())};
  CHECK(errorOf([&] { Device::adopt(handles); }).code() == ErrorCode::unsupported);
}
