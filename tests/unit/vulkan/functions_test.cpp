// SPDX-License-Identifier: Apache-2.0
// Functions from the caller's vkGetInstanceProcAddr, with a fake driver behind it that has no device.
#include "base/vulkan/functions.h"

#include <catch2/catch.hpp>
#include <cstdint>
#include <cstring>
#include <set>
#include <string>

#include "ibr/device.h"
#include "support/error_of.h"

using namespace ibr;
using Catch::Contains;
using test::errorOf;

namespace {

struct Fake {
  std::set<std::string> missing;              // functions that it lacks
  std::set<std::string> global, ofInstances;  // functions requested without and with an instance
  int created = 0, destroyed = 0;             // instances
};
Fake fake;
const auto kInstance = reinterpret_cast<VkInstance>(&fake);

VKAPI_ATTR VkResult VKAPI_CALL createInstance(const VkInstanceCreateInfo*, const VkAllocationCallbacks*,
                                              VkInstance* instance) {
  *instance = kInstance;
  ++fake.created;
  return VK_SUCCESS;
}
VKAPI_ATTR void VKAPI_CALL destroyInstance(VkInstance, const VkAllocationCallbacks*) {
  ++fake.destroyed;
}
VKAPI_ATTR VkResult VKAPI_CALL instanceExtensions(const char*, std::uint32_t* count, VkExtensionProperties*) {
  *count = 0;
  return VK_SUCCESS;
}
VKAPI_ATTR VkResult VKAPI_CALL physicalDevices(VkInstance, std::uint32_t* count, VkPhysicalDevice*) {
  *count = 0;
  return VK_SUCCESS;
}
VKAPI_ATTR void VKAPI_CALL deviceProperties(VkPhysicalDevice, VkPhysicalDeviceProperties* properties) {
  *properties = {.apiVersion = VK_API_VERSION_1_0};
}
VKAPI_ATTR void VKAPI_CALL memoryProperties(VkPhysicalDevice, VkPhysicalDeviceMemoryProperties* properties) {
  *properties = {};
}
VKAPI_ATTR void VKAPI_CALL queueFamilies(VkPhysicalDevice, std::uint32_t* count, VkQueueFamilyProperties*) {
  *count = 0;
}
VKAPI_ATTR void VKAPI_CALL unused() {
  FAIL("an unexpected function of Vulkan was called");
}
VKAPI_ATTR void VKAPI_CALL unusedOfOther() {
  unused();
}

PFN_vkVoidFunction functionOf(const std::string& name, PFN_vkVoidFunction other) {
  if (name == "vkCreateInstance") return reinterpret_cast<PFN_vkVoidFunction>(createInstance);
  if (name == "vkDestroyInstance") return reinterpret_cast<PFN_vkVoidFunction>(destroyInstance);
  if (name == "vkEnumerateInstanceExtensionProperties") return reinterpret_cast<PFN_vkVoidFunction>(instanceExtensions);
  if (name == "vkEnumeratePhysicalDevices") return reinterpret_cast<PFN_vkVoidFunction>(physicalDevices);
  if (name == "vkGetPhysicalDeviceProperties") return reinterpret_cast<PFN_vkVoidFunction>(deviceProperties);
  if (name == "vkGetPhysicalDeviceMemoryProperties") return reinterpret_cast<PFN_vkVoidFunction>(memoryProperties);
  if (name == "vkGetPhysicalDeviceQueueFamilyProperties") return reinterpret_cast<PFN_vkVoidFunction>(queueFamilies);
  return other;
}

PFN_vkVoidFunction requested(VkInstance instance, const char* name, PFN_vkVoidFunction other) {
  const bool isGlobal =
      std::strcmp(name, "vkCreateInstance") == 0 || std::strncmp(name, "vkEnumerateInstance", 19) == 0;
  if (isGlobal != !instance || fake.missing.contains(name)) return nullptr;
  (isGlobal ? fake.global : fake.ofInstances).insert(name);
  return functionOf(name, other);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL getFunction(VkInstance instance, const char* name) {
  return requested(instance, name, unused);
}
VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL getOther(VkInstance instance, const char* name) {
  return requested(instance, name, unusedOfOther);
}

const auto kPhysicalDevice = reinterpret_cast<VkPhysicalDevice>(&fake);

}  // namespace

TEST_CASE("the caller's vkGetInstanceProcAddr must not be null") {
  const Error error = errorOf([] { Device::loadFunctions(nullptr, kInstance); });
  CHECK(error.code() == ErrorCode::invalidInput);
  CHECK_THAT(error.what(), Contains("vkGetInstanceProcAddr"));
}

TEST_CASE("the caller's functions are called") {
  fake = {};
  Device::loadFunctions(getFunction, kInstance);
  CHECK(fake.global.contains("vkCreateInstance"));
  CHECK(fake.ofInstances.contains("vkQueueSubmit2"));
  CHECK(Device::list().empty());
  CHECK(fake.created == 1);
  CHECK(fake.destroyed == 1);
  CHECK_THAT(errorOf([] { Device::create(); }).what(), Contains("no device"));
  CHECK(fake.destroyed == 2);
}

TEST_CASE("the first missing function is named, and the functions stay as they were") {
  fake = {};
  Device::loadFunctions(getFunction, kInstance);
  const auto draw = vkCmdDraw;
  const std::string missing = GENERATE(as<std::string>{}, "vkCreateInstance", "vkCmdEndRendering", "vkWaitForFences");
  fake.missing = {missing};
  const Error error = errorOf([] { Device::loadFunctions(getOther, kInstance); });
  CHECK(error.code() == ErrorCode::unsupported);
  CHECK_THAT(error.what(), Contains(missing));
  CHECK(vkCmdDraw == draw);
  CHECK(vkGetInstanceProcAddr == getFunction);
  fake.missing = {};
  Device::loadFunctions(getOther, kInstance);
  CHECK(vkCmdDraw != draw);
  CHECK(vkGetInstanceProcAddr == getOther);
}

TEST_CASE("functions for windows may be missing") {
  fake = {.missing = {"vkCreateSwapchainKHR", "vkDestroySurfaceKHR"}};
  Device::loadFunctions(getFunction, kInstance);
  CHECK(vkCreateSwapchainKHR == nullptr);
  CHECK(vkDestroySurfaceKHR == nullptr);
  CHECK(vkQueuePresentKHR != nullptr);
}

TEST_CASE("without an instance the global functions are loaded, and the rest from the first instance") {
  fake = {};
  Device::loadFunctions(getFunction);
  CHECK(fake.global.size() == 3);
  CHECK(fake.ofInstances.empty());
  for (const Error& error :
       {errorOf([] { Device::describe(kPhysicalDevice); }), errorOf([] { Device::featuresFor(kPhysicalDevice); })}) {
    CHECK(error.code() == ErrorCode::invalidInput);
    CHECK_THAT(error.what(), Contains("loadFunctions"));
  }
  SECTION("of libibr") {
    CHECK(Device::list().empty());
  }
  SECTION("of an adopted device") {
    const DeviceHandles handles{.instance = kInstance,
                                .physicalDevice = kPhysicalDevice,
                                .device = reinterpret_cast<VkDevice>(&fake),
                                .queue = reinterpret_cast<VkQueue>(&fake)};
    CHECK_THAT(errorOf([&] { Device::adopt(handles); }).what(), Contains("Vulkan 1.3"));
  }
  CHECK(fake.created == fake.destroyed);
  CHECK(fake.ofInstances.contains("vkQueueSubmit2"));
  CHECK(Device::describe(kPhysicalDevice).missing.size() == 1);
}

TEST_CASE("an instance whose functions are incomplete is destroyed") {
  fake = {.missing = {"vkQueueSubmit2"}};
  Device::loadFunctions(getFunction);
  const Error error = errorOf([] { Device::create(); });
  CHECK(error.code() == ErrorCode::unsupported);
  CHECK_THAT(error.what(), Contains("vkQueueSubmit2"));
  CHECK(Device::list().empty());
  CHECK(fake.created == 2);
  CHECK(fake.destroyed == 2);
}
