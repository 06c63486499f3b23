// SPDX-License-Identifier: Apache-2.0
// The smallest program for a headset, which tests the test equipment. The program draws nothing.
#pragma once

#define XR_USE_GRAPHICS_API_VULKAN
#include <vulkan/vulkan.h>
// After the types that openxr_platform.h uses.
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace ibr::test {

/// Result of a failed call; printed as a line.
struct ProbeFailure {
  std::string call;
  XrResult result;
};

/// An instance with a session on a Vulkan device that the runtime chose.
struct ProbeSession {
  XrInstance instance = XR_NULL_HANDLE;
  XrSystemId system = XR_NULL_SYSTEM_ID;
  XrSession session = XR_NULL_HANDLE;
  XrSpace space = XR_NULL_HANDLE, handSpace = XR_NULL_HANDLE;
  XrActionSet actions = XR_NULL_HANDLE;
  XrAction select = XR_NULL_HANDLE, stick = XR_NULL_HANDLE, hand = XR_NULL_HANDLE;
  XrSwapchain colour = XR_NULL_HANDLE;
  VkInstance vulkan = VK_NULL_HANDLE;
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  bool depthLayer = false, visibilityMask = false;  // the runtime supports these extensions
  std::uint32_t width = 0, height = 0;
};

void checkXr(const char* call, XrResult result);

/// Prints {"extensions": …, "formats": …, "spaces": …, "size": …, "maskIndices": …}.
void openInstance(ProbeSession& probe);
void openSession(ProbeSession& probe);
void closeSession(ProbeSession& probe);
void closeInstance(ProbeSession& probe);

void print(const nlohmann::json& line);

}  // namespace ibr::test
