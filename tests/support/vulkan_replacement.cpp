// SPDX-License-Identifier: Apache-2.0
#include "support/vulkan_replacement.h"

#include <dlfcn.h>

#include <map>
#include <string>

#include "ibr/device.h"
#include "ibr/error.h"

namespace ibr::test {
namespace {

struct Replacement {
  PFN_vkVoidFunction function;
  void (*setReal)(PFN_vkVoidFunction);
};

std::map<std::string, Replacement>& replacements() {
  static std::map<std::string, Replacement> all;
  return all;
}

/// The loader's vkGetInstanceProcAddr; null if no loader is installed.
PFN_vkGetInstanceProcAddr loaderFunction() {
  static void* const library = ::dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
  return library ? reinterpret_cast<PFN_vkGetInstanceProcAddr>(::dlsym(library, "vkGetInstanceProcAddr")) : nullptr;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL getInstanceProcAddr(VkInstance instance, const char* name) {
  const PFN_vkGetInstanceProcAddr loader = loaderFunction();
  const PFN_vkVoidFunction real = loader ? loader(instance, name) : nullptr;
  const auto found = replacements().find(name);
  if (!real || found == replacements().end()) return real;
  found->second.setReal(real);
  return found->second.function;
}

}  // namespace

VulkanReplacement::VulkanReplacement(const char* name, PFN_vkVoidFunction function,
                                     void (*setReal)(PFN_vkVoidFunction)) {
  replacements()[name] = {function, setReal};
}

bool installVulkanReplacements() {
  try {
    Device::loadFunctions(getInstanceProcAddr);
    return true;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace ibr::test
