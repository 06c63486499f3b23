// SPDX-License-Identifier: Apache-2.0
#include "gpu/device/instance.h"

#include <vector>

#include "base/check.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/vulkan.h"

namespace ibr {

Instance::Instance(std::span<const std::string> extensions, bool validation, Messages& messages) {
  ensureGlobalFunctions();
  std::vector<const char*> enabled;
  for (const std::string& name : extensions) {
    check(hasInstanceExtension(name), ErrorCode::unsupported, "the Vulkan loader has no instance extension {}", name);
    enabled.push_back(name.c_str());
  }
  std::optional<Validation> validated;
  if (validation) {
    validated.emplace(messages);
    enabled.insert(enabled.end(), Validation::kExtensions.begin(), Validation::kExtensions.end());
  } else if (hasInstanceExtension(VK_EXT_DEBUG_UTILS_EXTENSION_NAME)) {
    enabled.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
  }

  const VkApplicationInfo application{
      .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .pEngineName = "libibr", .apiVersion = VK_API_VERSION_1_3};
  const VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                  .pNext = validated ? validated->chain() : nullptr,
                                  .pApplicationInfo = &application,
                                  .enabledLayerCount = validation ? 1u : 0u,
                                  .ppEnabledLayerNames = &Validation::kLayer,
                                  .enabledExtensionCount = std::uint32_t(enabled.size()),
                                  .ppEnabledExtensionNames = enabled.data()};
  VkInstance instance = VK_NULL_HANDLE;
  const VkResult result = vkCreateInstance(&info, nullptr, &instance);
  check(result != VK_ERROR_INCOMPATIBLE_DRIVER, ErrorCode::unsupported,
        "no Vulkan driver is installed (Debian: install mesa-vulkan-drivers, which needs no GPU)");
  vk(result, "vkCreateInstance");
  // The instance is owned before the other functions are loaded, which may fail.
  const auto destroy = vkGetInstanceProcAddr(instance, "vkDestroyInstance");
  instance_ = {instance, Destroy{reinterpret_cast<PFN_vkDestroyInstance>(destroy)}};
  ensureFunctions(instance);
  if (validation) messenger_.emplace(instance, messages);
}

}  // namespace ibr
