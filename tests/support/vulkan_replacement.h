// SPDX-License-Identifier: Apache-2.0
// Functions of a test program that libibr calls instead of the Vulkan loader's (Device::loadFunctions).
#pragma once

#include <vulkan/vulkan_core.h>

namespace ibr::test {

struct VulkanReplacement {
  /// `setReal` gets the loader's function whenever libibr asks for `name`.
  VulkanReplacement(const char* name, PFN_vkVoidFunction function, void (*setReal)(PFN_vkVoidFunction));
};

/// Makes libibr load its functions through the replacements. Call before main(), which creates the first device, and
/// after all replacements. Returns false if no loader is installed: the creation of a device reports that.
bool installVulkanReplacements();

}  // namespace ibr::test

/// Defines the function that replaces `name`; real_NAME is the loader's.
#define IBR_REPLACE(Result, name, parameters)                                             \
  PFN_##name real_##name = nullptr;                                                       \
  VKAPI_ATTR Result VKAPI_CALL my_##name parameters;                                      \
  const ::ibr::test::VulkanReplacement replaced_##name(                                   \
      #name, reinterpret_cast<PFN_vkVoidFunction>(&my_##name),                            \
      [](PFN_vkVoidFunction real) { real_##name = reinterpret_cast<PFN_##name>(real); }); \
  VKAPI_ATTR Result VKAPI_CALL my_##name parameters
