// SPDX-License-Identifier: Apache-2.0
#include "support/handmade_device.h"

#include <stdexcept>
#include <string>
#include <vector>

#include "base/vulkan/functions.h"
#include "support/gpu.h"

namespace ibr::test {
namespace {

void require(VkResult result) {
  if (result != VK_SUCCESS) throw std::runtime_error("the handmade device could not be created");
}

std::vector<const char*> pointers(const std::vector<std::string>& names) {
  std::vector<const char*> result;
  for (const std::string& name : names) result.push_back(name.c_str());
  return result;
}

}  // namespace

HandmadeDevice::HandmadeDevice(std::uint32_t apiVersion) : messages_(testLog()) {
  DeviceRequirements requirements = Device::requirements();
  if (apiVersion == 0) apiVersion = requirements.apiVersion;
  const Validation validation(messages_);
  const VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .apiVersion = apiVersion};
  auto instanceExtensions = pointers(requirements.instanceExtensions);
  instanceExtensions.insert(instanceExtensions.end(), Validation::kExtensions.begin(), Validation::kExtensions.end());
  const VkInstanceCreateInfo instanceInfo{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                          .pNext = validation.chain(),
                                          .pApplicationInfo = &application,
                                          .enabledLayerCount = 1,
                                          .ppEnabledLayerNames = &Validation::kLayer,
                                          .enabledExtensionCount = std::uint32_t(instanceExtensions.size()),
                                          .ppEnabledExtensionNames = instanceExtensions.data()};
  require(vkCreateInstance(&instanceInfo, nullptr, &instance_));
  messenger_.emplace(instance_, messages_);

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
  messenger_.reset();
  vkDestroyInstance(instance_, nullptr);
}

DeviceHandles HandmadeDevice::handles() const {
  return {.instance = instance_,
          .physicalDevice = physicalDevice_,
          .device = device_,
          .queue = queue_,
          .queueFamily = queueFamily_,
          .log = testLog(),
          .validationMessages = &messages_.validationMessages()};
}

}  // namespace ibr::test
