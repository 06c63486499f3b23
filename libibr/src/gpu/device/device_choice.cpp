// SPDX-License-Identifier: Apache-2.0
#include "gpu/device/device_choice.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <sstream>

#include "base/check.h"
#include "base/parse.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/vulkan.h"

namespace ibr {
namespace {

struct Feature {
  const char* name;
  VkBool32& (*of)(DeviceFeatures&);
};

// Required features, each with its reason.
constexpr Feature kFeatures[]{
    // Each cell is drawn into a slice of the depth range; geometry before the near plane must not be clipped.
    {"depthClamp", [](DeviceFeatures& f) -> VkBool32& { return f.core.features.depthClamp; }},
    // For the paper's method of counting colours.
    {"fragmentStoresAndAtomics",
     [](DeviceFeatures& f) -> VkBool32& { return f.core.features.fragmentStoresAndAtomics; }},
    // C++ and shaders share structures in the layout of C++.
    {"scalarBlockLayout", [](DeviceFeatures& f) -> VkBool32& { return f.vulkan12.scalarBlockLayout; }},
    // For all barriers.
    {"synchronization2", [](DeviceFeatures& f) -> VkBool32& { return f.vulkan13.synchronization2; }},
    // Draws into the caller's image, for which there is no VkFramebuffer.
    {"dynamicRendering", [](DeviceFeatures& f) -> VkBool32& { return f.vulkan13.dynamicRendering; }},
};

// Optional features, by the names that users see, each with the fallback.
constexpr Feature kOptionalFeatures[]{
    // Alignment by the passes of the optimiser; otherwise on the CPU.
    {"int64", [](DeviceFeatures& f) -> VkBool32& { return f.core.features.shaderInt64; }},
    {"int64-atomics", [](DeviceFeatures& f) -> VkBool32& { return f.vulkan12.shaderBufferInt64Atomics; }},
    // Textures in BC1 and BC7 stay compressed; otherwise they are decoded to RGBA8.
    {"bc", [](DeviceFeatures& f) -> VkBool32& { return f.core.features.textureCompressionBC; }},
    // Both views in one pass if the device does that correctly (gpu/draw/multiview.h); otherwise one pass each.
    {"multiview", [](DeviceFeatures& f) -> VkBool32& { return f.vulkan11.multiview; }},
};

DeviceFeatures featuresOf(VkPhysicalDevice device) {
  DeviceFeatures has;
  has.link();
  vkGetPhysicalDeviceFeatures2(device, &has.core);
  return has;
}

std::string versionText(std::uint32_t version) {
  return fmt::format("{}.{}.{}", VK_API_VERSION_MAJOR(version), VK_API_VERSION_MINOR(version),
                     VK_API_VERSION_PATCH(version));
}

std::vector<VkQueueFamilyProperties> queueFamilies(VkPhysicalDevice device) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  return families;
}

std::vector<std::string> missingFeatures(VkPhysicalDevice device) {
  DeviceFeatures has = featuresOf(device);
  std::vector<std::string> missing;
  for (const Feature& feature : kFeatures)
    if (!feature.of(has)) missing.push_back(feature.name);
  return missing;
}

std::vector<std::string> missingExtensions(VkPhysicalDevice device, std::span<const std::string> wanted) {
  std::uint32_t count = 0;
  vk(vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr), "vkEnumerateDeviceExtensionProperties");
  std::vector<VkExtensionProperties> has(count);
  vk(vkEnumerateDeviceExtensionProperties(device, nullptr, &count, has.data()), "vkEnumerateDeviceExtensionProperties");
  std::vector<std::string> missing;
  for (const std::string& name : wanted)
    if (std::none_of(has.begin(), has.end(), [&](const auto& e) { return name == e.extensionName; }))
      missing.push_back(name);
  return missing;
}

std::string driverText(VkPhysicalDevice device, const VkPhysicalDeviceProperties& core) {
  if (core.apiVersion < VK_API_VERSION_1_2) return fmt::format("driver version {:#x}", core.driverVersion);
  VkPhysicalDeviceDriverProperties driver{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
  VkPhysicalDeviceProperties2 properties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &driver};
  vkGetPhysicalDeviceProperties2(device, &properties);
  return fmt::format("{} {}", driver.driverName, driver.driverInfo);
}

int typeRank(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return 0;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return 1;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return 2;
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
      return 3;
    default:
      return 4;
  }
}

std::string lowerCase(std::string text) {
  for (char& c : text) c = char(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// Matches an index into the list or a part of the name; a number beyond the list is a part of a name.
bool matches(const std::string& wish, std::size_t index, std::size_t count, const std::string& name) {
  const auto number = parseInt(wish);
  if (number && *number >= 0 && std::uint64_t(*number) < count) return std::uint64_t(*number) == index;
  return lowerCase(name).find(lowerCase(wish)) != std::string::npos;
}

}  // namespace

const VkPhysicalDeviceFeatures2* DeviceFeatures::link(void* next) {
  core.pNext = &vulkan11;
  vulkan11.pNext = &vulkan12;
  vulkan12.pNext = &vulkan13;
  vulkan13.pNext = next;
  return &core;
}

DeviceRequirements Device::requirements() {
  DeviceRequirements requirements;
  requirements.apiVersion = VK_API_VERSION_1_3;
  requirements.queueFlags = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
  for (const Feature& feature : kFeatures) feature.of(requirements.features) = VK_TRUE;
  for (const Feature& feature : kOptionalFeatures) feature.of(requirements.optionalFeatures) = VK_TRUE;
  return requirements;
}

std::vector<std::string> Device::optionalFeatureNames() {
  std::vector<std::string> names;
  for (const Feature& feature : kOptionalFeatures) names.emplace_back(feature.name);
  return names;
}

std::vector<std::string> Device::disabledFeatures(const std::string& list) {
  const char* environment = std::getenv("IBR_DISABLE_FEATURES");
  const bool fromEnvironment = list.empty() && environment && *environment;
  const std::vector<std::string> known = optionalFeatureNames();
  std::vector<std::string> names;
  std::istringstream words(fromEnvironment ? environment : list);
  for (std::string name; std::getline(words, name, ',');) {
    check(std::find(known.begin(), known.end(), name) != known.end(), ErrorCode::invalidInput,
          "{}'{}' is not an optional feature; known features: {}", fromEnvironment ? "IBR_DISABLE_FEATURES: " : "",
          name, fmt::join(known, ", "));
    names.push_back(name);
  }
  return names;
}

void removeFeatures(DeviceFeatures& features, const std::string& disabled) {
  const std::vector<std::string> names = Device::disabledFeatures(disabled);
  for (const Feature& feature : kOptionalFeatures)
    if (std::find(names.begin(), names.end(), feature.name) != names.end()) feature.of(features) = VK_FALSE;
}

void addOptionalFeatures(VkPhysicalDevice device, DeviceFeatures& features, const std::string& disabled) {
  DeviceFeatures has = featuresOf(device);
  removeFeatures(has, disabled);
  for (const Feature& feature : kOptionalFeatures)
    if (feature.of(has)) feature.of(features) = VK_TRUE;
}

DeviceDescription Device::describe(VkPhysicalDevice device) {
  ensureFunctions(VK_NULL_HANDLE);
  return ibr::describe(device);
}

DeviceFeatures Device::featuresFor(VkPhysicalDevice device) {
  ensureFunctions(VK_NULL_HANDLE);
  DeviceFeatures features = requirements().features;
  addOptionalFeatures(device, features);
  return features;
}

std::vector<VkPhysicalDevice> physicalDevices(VkInstance instance) {
  std::uint32_t count = 0;
  const VkResult result = vkEnumeratePhysicalDevices(instance, &count, nullptr);
  if (result == VK_ERROR_INITIALIZATION_FAILED) return {};  // returned by the loader if the drivers find no device
  vk(result, "vkEnumeratePhysicalDevices");
  std::vector<VkPhysicalDevice> devices(count);
  vk(vkEnumeratePhysicalDevices(instance, &count, devices.data()), "vkEnumeratePhysicalDevices");
  return devices;
}

DeviceDescription describe(VkPhysicalDevice device, std::span<const std::string> extensions) {
  VkPhysicalDeviceProperties properties;
  vkGetPhysicalDeviceProperties(device, &properties);
  VkPhysicalDeviceMemoryProperties memory;
  vkGetPhysicalDeviceMemoryProperties(device, &memory);
  DeviceDescription description{.name = properties.deviceName,
                                .driver = driverText(device, properties),
                                .apiVersion = properties.apiVersion,
                                .type = properties.deviceType};
  for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i)
    if (memory.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT)
      description.memoryBytes += memory.memoryHeaps[i].size;

  const DeviceRequirements requirements = Device::requirements();
  std::vector<std::string>& missing = description.missing;
  if (properties.apiVersion < requirements.apiVersion) {
    missing.push_back(fmt::format("Vulkan {} (device has {})", versionText(requirements.apiVersion),
                                  versionText(properties.apiVersion)));
    return description;  // an older device does not report these features
  }
  DeviceFeatures has = featuresOf(device);
  for (const Feature& feature : kOptionalFeatures)
    if (feature.of(has)) description.features.emplace_back(feature.name);
  missing = missingFeatures(device);
  for (std::string& name : missingExtensions(device, extensions)) missing.push_back(std::move(name));
  description.queueFamily = queueFamily(device);
  if (!description.queueFamily) missing.emplace_back("a queue for graphics and compute");
  return description;
}

std::vector<std::string> missingQueueCapabilities(VkPhysicalDevice device, std::uint32_t family) {
  const auto families = queueFamilies(device);
  if (family >= families.size())
    return {fmt::format("queue family {} (device has {} families)", family, families.size())};
  const VkQueueFlags required = Device::requirements().queueFlags;
  if ((families[family].queueFlags & required) == required) return {};
  return {fmt::format("graphics and compute in queue family {}", family)};
}

std::optional<std::uint32_t> queueFamily(VkPhysicalDevice device) {
  const auto count = std::uint32_t(queueFamilies(device).size());
  for (std::uint32_t family = 0; family < count; ++family)
    if (missingQueueCapabilities(device, family).empty()) return family;
  return std::nullopt;
}

std::size_t choose(std::span<const DeviceDescription> devices, const std::string& option) {
  const char* environment = std::getenv("IBR_DEVICE");
  const bool fromEnvironment = option.empty() && environment && *environment;
  const std::string wish = fromEnvironment ? environment : option;

  std::vector<std::string> rejected;
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const DeviceDescription& device = devices[i];
    if (!wish.empty() && !matches(wish, i, devices.size(), device.name))
      rejected.push_back(fmt::format("{} '{}' does not match", i, device.name));
    else if (!device.missing.empty())
      rejected.push_back(fmt::format("{} '{}' lacks {}", i, device.name, fmt::join(device.missing, ", ")));
    else if (!best || typeRank(device.type) < typeRank(devices[*best].type))
      best = i;
  }
  if (best) return *best;
  fail(ErrorCode::unsupported, "no usable Vulkan device{}: {}",
       wish.empty() ? std::string() : fmt::format(" '{}'{}", wish, fromEnvironment ? " (IBR_DEVICE)" : ""),
       rejected.empty()
           ? "the installed drivers find no device (Debian: install mesa-vulkan-drivers, which needs no GPU)"
           : fmt::format("{}", fmt::join(rejected, "; ")));
}

}  // namespace ibr
