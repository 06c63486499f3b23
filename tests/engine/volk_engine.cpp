// SPDX-License-Identifier: Apache-2.0
#include "volk_engine.h"

#include <array>
#include <cstdio>
#include <stdexcept>
#include <vector>

namespace ibr::test {
namespace {

constexpr const char* kLayer = "VK_LAYER_KHRONOS_validation";

void require(VkResult result, const char* call) {
  if (result != VK_SUCCESS) throw std::runtime_error(std::string(call) + " failed");
}

std::vector<const char*> pointers(const std::vector<std::string>& names) {
  std::vector<const char*> result;
  for (const std::string& name : names) result.push_back(name.c_str());
  return result;
}

VKAPI_ATTR VkBool32 VKAPI_CALL receive(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                       const VkDebugUtilsMessengerCallbackDataEXT* data, void* count) {
  std::fprintf(stderr, "%s\n", data->pMessage);
  ++*static_cast<std::atomic<std::uint64_t>*>(count);
  return VK_FALSE;
}

}  // namespace

VolkEngine::VolkEngine(const std::string& physicalDevice) {
  require(volkInitialize(), "volkInitialize");
  makeInstance();
  makeDevice(physicalDevice);
}

VolkEngine::~VolkEngine() {
  vkDestroyDevice(device_, nullptr);
  vkDestroyDebugUtilsMessengerEXT(instance_, messenger_, nullptr);
  vkDestroyInstance(instance_, nullptr);
}

void VolkEngine::makeInstance() {
  const DeviceRequirements requirements = Device::requirements();
  std::vector<const char*> extensions = pointers(requirements.instanceExtensions);
  extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
  const VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                      .apiVersion = requirements.apiVersion};
  const VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                  .pApplicationInfo = &application,
                                  .enabledLayerCount = 1,
                                  .ppEnabledLayerNames = &kLayer,
                                  .enabledExtensionCount = std::uint32_t(extensions.size()),
                                  .ppEnabledExtensionNames = extensions.data()};
  require(vkCreateInstance(&info, nullptr, &instance_), "vkCreateInstance");
  volkLoadInstance(instance_);
  const VkDebugUtilsMessengerCreateInfoEXT messengerInfo{
      .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
      .messageSeverity =
          VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
      .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
      .pfnUserCallback = receive,
      .pUserData = &messages_};
  require(vkCreateDebugUtilsMessengerEXT(instance_, &messengerInfo, nullptr, &messenger_),
          "vkCreateDebugUtilsMessengerEXT");
}

void VolkEngine::makeDevice(const std::string& name) {
  std::array<VkPhysicalDevice, 16> devices{};
  auto count = std::uint32_t(devices.size());
  if (vkEnumeratePhysicalDevices(instance_, &count, devices.data()) < 0) count = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(devices[i], &properties);
    if (name == properties.deviceName) physicalDevice_ = devices[i];
  }
  if (!physicalDevice_) throw std::runtime_error("there is no physical device " + name);

  DeviceRequirements requirements = Device::requirements();
  std::array<VkQueueFamilyProperties, 16> families{};
  count = std::uint32_t(families.size());
  vkGetPhysicalDeviceQueueFamilyProperties(physicalDevice_, &count, families.data());
  while (queueFamily_ < count &&
         (families[queueFamily_].queueFlags & requirements.queueFlags) != requirements.queueFlags)
    ++queueFamily_;
  const float priority = 1;
  const VkDeviceQueueCreateInfo queueInfo{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                          .queueFamilyIndex = queueFamily_,
                                          .queueCount = 1,
                                          .pQueuePriorities = &priority};
  const std::vector<const char*> extensions = pointers(requirements.deviceExtensions);
  const VkDeviceCreateInfo info{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                .pNext = requirements.features.link(),
                                .queueCreateInfoCount = 1,
                                .pQueueCreateInfos = &queueInfo,
                                .enabledExtensionCount = std::uint32_t(extensions.size()),
                                .ppEnabledExtensionNames = extensions.data()};
  require(vkCreateDevice(physicalDevice_, &info, nullptr, &device_), "vkCreateDevice");
  volkLoadDevice(device_);  // the engine's pointers bypass the loader; libibr's do not
  vkGetDeviceQueue(device_, queueFamily_, 0, &queue_);
}

DeviceHandles VolkEngine::handles() const {
  return {.instance = instance_,
          .physicalDevice = physicalDevice_,
          .device = device_,
          .queue = queue_,
          .queueFamily = queueFamily_,
          .validationMessages = &messages_};
}

}  // namespace ibr::test
