// SPDX-License-Identifier: Apache-2.0
#include "vr/headset/headset.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <span>
#include <string_view>

#include "base/check.h"
#include "base/vulkan/vulkan.h"

namespace ibr::app {
namespace {

std::vector<const char*> pointers(const std::vector<std::string>& names) {
  std::vector<const char*> result;
  for (const std::string& name : names) result.push_back(name.c_str());
  return result;
}

std::vector<XrExtensionProperties> instanceExtensions() {
  std::uint32_t count = 0;
  xr(xrEnumerateInstanceExtensionProperties(nullptr, 0, &count, nullptr), "xrEnumerateInstanceExtensionProperties");
  std::vector<XrExtensionProperties> all(count, {.type = XR_TYPE_EXTENSION_PROPERTIES});
  xr(xrEnumerateInstanceExtensionProperties(nullptr, count, &count, all.data()),
     "xrEnumerateInstanceExtensionProperties");
  return all;
}

bool has(const std::vector<XrExtensionProperties>& all, std::string_view name) {
  return std::ranges::any_of(all, [&](const auto& one) { return std::string_view(one.extensionName) == name; });
}

bool deviceHas(VkPhysicalDevice device, const std::vector<std::string>& extensions) {
  std::uint32_t count = 0;
  vk(vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr), "vkEnumerateDeviceExtensionProperties");
  std::vector<VkExtensionProperties> all(count);
  vk(vkEnumerateDeviceExtensionProperties(device, nullptr, &count, all.data()), "vkEnumerateDeviceExtensionProperties");
  return std::ranges::all_of(extensions, [&](const std::string& name) {
    return std::ranges::any_of(all, [&](const auto& one) { return name == one.extensionName; });
  });
}

std::string versionText(XrVersion version) {
  return fmt::format("{}.{}.{}", XR_VERSION_MAJOR(version), XR_VERSION_MINOR(version), XR_VERSION_PATCH(version));
}

}  // namespace

// Monado 25 appends VkPhysicalDeviceTimelineSemaphoreFeatures to the device's create-info, although the Vulkan 1.2
// features are already there. Drivers accept that. The validation message about it appears once and is not counted.
LogCallback Headset::counting(const HeadsetOptions& options) {
  return [this, log = options.log, count = options.messages](LogLevel level, std::string_view text) {
    if (text.find("VUID-VkDeviceCreateInfo-pNext-02830") == std::string_view::npos) {
      if (count && text.starts_with("Vulkan validation")) ++*count;
      if (log) log(level, text);
    } else if (!runtimeMessageReported_.exchange(true) && log) {
      log(LogLevel::info, "validation error of the OpenXR runtime, ignored: device features passed twice (VUID 02830)");
    }
  };
}

Headset::Headset(const HeadsetOptions& options) : messages_(counting(options)) {
  makeInstance();
  findSystem();
  makeVulkanInstance(options);
  makeVulkanDevice(options);
  messages_.send(LogLevel::info, fmt::format("headset: {}", name_));
}

void Headset::makeInstance() {
  const auto offered = instanceExtensions();
  check(has(offered, XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME), ErrorCode::unsupported,
        "the OpenXR runtime does not support Vulkan: it lacks {}", XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME);
  std::vector<const char*> enabled{XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME};
  const auto enableIfSupported = [&](const char* name) {
    if (!has(offered, name)) return false;
    enabled.push_back(name);
    return true;
  };
  supportsDepthLayer_ = enableIfSupported(XR_KHR_COMPOSITION_LAYER_DEPTH_EXTENSION_NAME);
  supportsVisibilityMask_ = enableIfSupported(XR_KHR_VISIBILITY_MASK_EXTENSION_NAME);
  XrInstanceCreateInfo info{.type = XR_TYPE_INSTANCE_CREATE_INFO};
  std::strcpy(info.applicationInfo.applicationName, "ibr-vr");
  std::strcpy(info.applicationInfo.engineName, "libibr");
  info.applicationInfo.apiVersion = XR_MAKE_VERSION(1, 0, 0);
  info.enabledExtensionCount = std::uint32_t(enabled.size());
  info.enabledExtensionNames = enabled.data();
  XrInstance instance = XR_NULL_HANDLE;
  xr(xrCreateInstance(&info, &instance), "xrCreateInstance");
  instance_ = XrInstanceOwner(instance);
}

void Headset::findSystem() {
  XrInstanceProperties runtime{.type = XR_TYPE_INSTANCE_PROPERTIES};
  xr(xrGetInstanceProperties(instance(), &runtime), "xrGetInstanceProperties");
  const XrSystemGetInfo info{
      .type = XR_TYPE_SYSTEM_GET_INFO, .next = nullptr, .formFactor = XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY};
  xr(xrGetSystem(instance(), &info, &system_), "xrGetSystem");
  XrSystemProperties system{.type = XR_TYPE_SYSTEM_PROPERTIES};
  xr(xrGetSystemProperties(instance(), system_, &system), "xrGetSystemProperties");
  name_ = fmt::format("{} by {} {}", system.systemName, runtime.runtimeName, versionText(runtime.runtimeVersion));
}

void Headset::makeVulkanInstance(const HeadsetOptions& options) {
  XrGraphicsRequirementsVulkan2KHR range{.type = XR_TYPE_GRAPHICS_REQUIREMENTS_VULKAN2_KHR};
  xr(xrFunction<PFN_xrGetVulkanGraphicsRequirements2KHR>(instance(), "xrGetVulkanGraphicsRequirements2KHR")(
         instance(), system_, &range),
     "xrGetVulkanGraphicsRequirements2KHR");
  const DeviceRequirements needs = Device::requirements();
  const XrVersion wanted =
      XR_MAKE_VERSION(VK_API_VERSION_MAJOR(needs.apiVersion), VK_API_VERSION_MINOR(needs.apiVersion), 0);
  check(wanted >= range.minApiVersionSupported, ErrorCode::unsupported, "{} requires at least Vulkan {}, not {}", name_,
        versionText(range.minApiVersionSupported), versionText(wanted));

  std::vector<std::string> names = needs.instanceExtensions;
  names.insert(names.end(), options.instanceExtensions.begin(), options.instanceExtensions.end());
  ensureGlobalFunctions();
  std::optional<Validation> validation;
  if (options.validation) {
    validation.emplace(messages_);
    names.insert(names.end(), Validation::kExtensions.begin(), Validation::kExtensions.end());
  }
  const std::vector<const char*> extensions = pointers(names);
  const VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                      .pApplicationName = "ibr-vr",
                                      .pEngineName = "libibr",
                                      .apiVersion = needs.apiVersion};
  const VkInstanceCreateInfo vulkanInfo{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                        .pNext = validation ? validation->chain() : nullptr,
                                        .pApplicationInfo = &application,
                                        .enabledLayerCount = validation ? 1u : 0u,
                                        .ppEnabledLayerNames = &Validation::kLayer,
                                        .enabledExtensionCount = std::uint32_t(extensions.size()),
                                        .ppEnabledExtensionNames = extensions.data()};
  const XrVulkanInstanceCreateInfoKHR info{.type = XR_TYPE_VULKAN_INSTANCE_CREATE_INFO_KHR,
                                           .next = nullptr,
                                           .systemId = system_,
                                           .createFlags = 0,
                                           .pfnGetInstanceProcAddr = vkGetInstanceProcAddr,
                                           .vulkanCreateInfo = &vulkanInfo,
                                           .vulkanAllocator = nullptr};
  VkInstance vulkan = VK_NULL_HANDLE;
  VkResult result = VK_SUCCESS;
  xr(xrFunction<PFN_xrCreateVulkanInstanceKHR>(instance(), "xrCreateVulkanInstanceKHR")(instance(), &info, &vulkan,
                                                                                        &result),
     "xrCreateVulkanInstanceKHR");
  vk(result, "vkCreateInstance, by the OpenXR runtime");
  vulkan_.reset(vulkan);
  if (validation) messenger_.emplace(vulkan, messages_);
}

void Headset::makeVulkanDevice(const HeadsetOptions& options) {
  const XrVulkanGraphicsDeviceGetInfoKHR whichInfo{.type = XR_TYPE_VULKAN_GRAPHICS_DEVICE_GET_INFO_KHR,
                                                   .next = nullptr,
                                                   .systemId = system_,
                                                   .vulkanInstance = vulkan_.get()};
  xr(xrFunction<PFN_xrGetVulkanGraphicsDevice2KHR>(instance(), "xrGetVulkanGraphicsDevice2KHR")(instance(), &whichInfo,
                                                                                                &physicalDevice_),
     "xrGetVulkanGraphicsDevice2KHR");
  const DeviceDescription description = Device::describe(physicalDevice_);
  check(description.missing.empty(), ErrorCode::unsupported, "{}, which the headset is connected to, lacks {}",
        description.name, fmt::join(description.missing, ", "));
  queueFamily_ = description.queueFamily.value();
  const DeviceRequirements needs = Device::requirements();
  std::vector<std::string> names = needs.deviceExtensions;
  hasExtensions_ = deviceHas(physicalDevice_, options.deviceExtensions);
  if (hasExtensions_) names.insert(names.end(), options.deviceExtensions.begin(), options.deviceExtensions.end());
  const std::vector<const char*> extensions = pointers(names);
  DeviceFeatures features = Device::featuresFor(physicalDevice_);
  optionalFeatures_ = features;
  const float priority = 1;
  const VkDeviceQueueCreateInfo queueInfo{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                          .queueFamilyIndex = queueFamily_,
                                          .queueCount = 1,
                                          .pQueuePriorities = &priority};
  const VkDeviceCreateInfo vulkanInfo{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                      .pNext = features.link(),
                                      .queueCreateInfoCount = 1,
                                      .pQueueCreateInfos = &queueInfo,
                                      .enabledExtensionCount = std::uint32_t(extensions.size()),
                                      .ppEnabledExtensionNames = extensions.data()};
  const XrVulkanDeviceCreateInfoKHR info{.type = XR_TYPE_VULKAN_DEVICE_CREATE_INFO_KHR,
                                         .next = nullptr,
                                         .systemId = system_,
                                         .createFlags = 0,
                                         .pfnGetInstanceProcAddr = vkGetInstanceProcAddr,
                                         .vulkanPhysicalDevice = physicalDevice_,
                                         .vulkanCreateInfo = &vulkanInfo,
                                         .vulkanAllocator = nullptr};
  VkDevice device = VK_NULL_HANDLE;
  VkResult result = VK_SUCCESS;
  xr(xrFunction<PFN_xrCreateVulkanDeviceKHR>(instance(), "xrCreateVulkanDeviceKHR")(instance(), &info, &device,
                                                                                    &result),
     "xrCreateVulkanDeviceKHR");
  vk(result, "vkCreateDevice, by the OpenXR runtime");
  device_.reset(device);
  vkGetDeviceQueue(device, queueFamily_, 0, &queue_);
  VkPhysicalDeviceProperties properties{};
  vkGetPhysicalDeviceProperties(physicalDevice_, &properties);
  pipelines_.emplace(device, properties, options.pipelineCache, messages_);
}

XrGraphicsBindingVulkan2KHR Headset::binding() const noexcept {
  return {.type = XR_TYPE_GRAPHICS_BINDING_VULKAN2_KHR,
          .next = nullptr,
          .instance = vulkan_.get(),
          .physicalDevice = physicalDevice_,
          .device = device_.get(),
          .queueFamilyIndex = queueFamily_,
          .queueIndex = 0};
}

Device Headset::device(LogCallback log) {
  return Device::adopt({.instance = vulkan_.get(),
                        .physicalDevice = physicalDevice_,
                        .device = device_.get(),
                        .queue = queue_,
                        .queueFamily = queueFamily_,
                        .optionalFeatures = optionalFeatures_,
                        .log = std::move(log),
                        .pipelineCache = pipelines_->get(),
                        .queueMutex = &queueMutex_,
                        .validationMessages = &messages_.validationMessages()});
}

}  // namespace ibr::app
