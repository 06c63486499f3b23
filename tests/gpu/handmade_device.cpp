// SPDX-License-Identifier: Apache-2.0
#include "handmade_device.h"

#include <stdexcept>
#include <string>
#include <vector>

#include "support/gpu.h"

namespace ibr::test {
namespace {

void require(VkResult result) {
  if (result != VK_SUCCESS) throw std::runtime_error("the handmade device could not be made");
}

VKAPI_ATTR VkBool32 VKAPI_CALL receive(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                       const VkDebugUtilsMessengerCallbackDataEXT* data, void* log) {
  (*static_cast<LogCallback*>(log))(LogLevel::error, data->pMessage);
  return VK_FALSE;
}

std::vector<const char*> pointers(const std::vector<std::string>& names) {
  std::vector<const char*> result;
  for (const std::string& name : names) result.push_back(name.c_str());
  return result;
}

}  // namespace

HandmadeDevice::HandmadeDevice(std::uint32_t apiVersion) : log_(testLog()) {
  DeviceRequirements requirements = Device::requirements();
  if (apiVersion == 0) apiVersion = requirements.apiVersion;
  const VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .apiVersion = apiVersion};
  const VkDebugUtilsMessengerCreateInfoEXT messengerInfo{
      .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
      .messageSeverity =
          VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
      .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
      .pfnUserCallback = receive,
      .pUserData = &log_};
  const char* const layer = "VK_LAYER_KHRONOS_validation";
  requirements.instanceExtensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
  const auto instanceExtensions = pointers(requirements.instanceExtensions);
  const VkInstanceCreateInfo instanceInfo{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                          .pNext = &messengerInfo,
                                          .pApplicationInfo = &application,
                                          .enabledLayerCount = 1,
                                          .ppEnabledLayerNames = &layer,
                                          .enabledExtensionCount = std::uint32_t(instanceExtensions.size()),
                                          .ppEnabledExtensionNames = instanceExtensions.data()};
  require(vkCreateInstance(&instanceInfo, nullptr, &instance_));
  require(reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(vkGetInstanceProcAddr(
      instance_, "vkCreateDebugUtilsMessengerEXT"))(instance_, &messengerInfo, nullptr, &messenger_));

  std::uint32_t count = 0;
  require(vkEnumeratePhysicalDevices(instance_, &count, nullptr));
  std::vector<VkPhysicalDevice> devices(count);
  require(vkEnumeratePhysicalDevices(instance_, &count, devices.data()));
  for (const VkPhysicalDevice device : devices) {
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(device, &properties);
    if (std::string(properties.deviceName) == testDevice().properties().deviceName) physicalDevice_ = device;
  }
  queueFamily_ = testDevice().queueFamily();

  const float priority = 0.5f;
  const VkDeviceQueueCreateInfo queueInfo{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                          .queueFamilyIndex = queueFamily_,
                                          .queueCount = 1,
                                          .pQueuePriorities = &priority};
  const auto deviceExtensions = pointers(requirements.deviceExtensions);
  const VkDeviceCreateInfo deviceInfo{
      .sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
      .pNext = apiVersion >= requirements.apiVersion ? requirements.features.link() : nullptr,
      .queueCreateInfoCount = 1,
      .pQueueCreateInfos = &queueInfo,
      .enabledExtensionCount = std::uint32_t(deviceExtensions.size()),
      .ppEnabledExtensionNames = deviceExtensions.data()};
  require(vkCreateDevice(physicalDevice_, &deviceInfo, nullptr, &device_));
  vkGetDeviceQueue(device_, queueFamily_, 0, &queue_);
}

HandmadeDevice::~HandmadeDevice() {
  vkDestroyDevice(device_, nullptr);
  reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
      vkGetInstanceProcAddr(instance_, "vkDestroyDebugUtilsMessengerEXT"))(instance_, messenger_, nullptr);
  vkDestroyInstance(instance_, nullptr);
}

}  // namespace ibr::test
