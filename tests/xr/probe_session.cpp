// SPDX-License-Identifier: Apache-2.0
#include "probe.h"

#include <cstring>
#include <iostream>
#include <nlohmann/json.hpp>

namespace ibr::test {

using nlohmann::json;

void print(const json& line) {
  std::cout << line.dump() << std::endl;
}

void checkXr(const char* call, XrResult result) {
  if (XR_FAILED(result)) throw ProbeFailure{call, result};
}

namespace {

void checkVk(const char* call, VkResult result) {
  if (result != VK_SUCCESS) throw ProbeFailure{call, XR_ERROR_RUNTIME_FAILURE};
}

template <class F>
F function(XrInstance instance, const char* name) {
  F found = nullptr;
  checkXr(name, xrGetInstanceProcAddr(instance, name, reinterpret_cast<PFN_xrVoidFunction*>(&found)));
  return found;
}

bool hasExtension(const char* name) {
  std::uint32_t count = 0;
  checkXr("xrEnumerateInstanceExtensionProperties",
          xrEnumerateInstanceExtensionProperties(nullptr, 0, &count, nullptr));
  std::vector<XrExtensionProperties> all(count, {XR_TYPE_EXTENSION_PROPERTIES});
  checkXr("xrEnumerateInstanceExtensionProperties",
          xrEnumerateInstanceExtensionProperties(nullptr, count, &count, all.data()));
  for (const XrExtensionProperties& one : all)
    if (std::strcmp(one.extensionName, name) == 0) return true;
  return false;
}

XrPath path(XrInstance instance, const char* text) {
  XrPath made = XR_NULL_PATH;
  checkXr("xrStringToPath", xrStringToPath(instance, text, &made));
  return made;
}

XrAction makeAction(XrActionSet set, const char* name, XrActionType type) {
  XrActionCreateInfo info{XR_TYPE_ACTION_CREATE_INFO};
  std::strcpy(info.actionName, name);
  std::strcpy(info.localizedActionName, name);
  info.actionType = type;
  XrAction action = XR_NULL_HANDLE;
  checkXr("xrCreateAction", xrCreateAction(set, &info, &action));
  return action;
}

void makeActions(ProbeSession& p) {
  XrActionSetCreateInfo set{XR_TYPE_ACTION_SET_CREATE_INFO};
  std::strcpy(set.actionSetName, "probe");
  std::strcpy(set.localizedActionSetName, "probe");
  checkXr("xrCreateActionSet", xrCreateActionSet(p.instance, &set, &p.actions));
  p.select = makeAction(p.actions, "select", XR_ACTION_TYPE_BOOLEAN_INPUT);
  p.stick = makeAction(p.actions, "stick", XR_ACTION_TYPE_VECTOR2F_INPUT);
  p.hand = makeAction(p.actions, "hand", XR_ACTION_TYPE_POSE_INPUT);
  const std::array bindings{
      XrActionSuggestedBinding{p.select, path(p.instance, "/user/hand/right/input/trigger/click")},
      XrActionSuggestedBinding{p.stick, path(p.instance, "/user/hand/left/input/thumbstick")},
      XrActionSuggestedBinding{p.hand, path(p.instance, "/user/hand/right/input/aim/pose")}};
  XrInteractionProfileSuggestedBinding suggested{XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING};
  suggested.interactionProfile = path(p.instance, "/interaction_profiles/valve/index_controller");
  suggested.countSuggestedBindings = std::uint32_t(bindings.size());
  suggested.suggestedBindings = bindings.data();
  checkXr("xrSuggestInteractionProfileBindings", xrSuggestInteractionProfileBindings(p.instance, &suggested));
}

void makeDevice(ProbeSession& p) {
  XrGraphicsRequirementsVulkanKHR requirements{XR_TYPE_GRAPHICS_REQUIREMENTS_VULKAN2_KHR};
  checkXr("xrGetVulkanGraphicsRequirements2KHR",
          function<PFN_xrGetVulkanGraphicsRequirements2KHR>(p.instance, "xrGetVulkanGraphicsRequirements2KHR")(
              p.instance, p.system, &requirements));
  VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
  application.apiVersion = VK_API_VERSION_1_2;
  VkInstanceCreateInfo instance{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
  instance.pApplicationInfo = &application;
  XrVulkanInstanceCreateInfoKHR xrInstance{XR_TYPE_VULKAN_INSTANCE_CREATE_INFO_KHR};
  xrInstance.systemId = p.system;
  xrInstance.pfnGetInstanceProcAddr = &vkGetInstanceProcAddr;
  xrInstance.vulkanCreateInfo = &instance;
  VkResult result = VK_SUCCESS;
  checkXr("xrCreateVulkanInstanceKHR", function<PFN_xrCreateVulkanInstanceKHR>(p.instance, "xrCreateVulkanInstanceKHR")(
                                           p.instance, &xrInstance, &p.vulkan, &result));
  checkVk("vkCreateInstance", result);
  XrVulkanGraphicsDeviceGetInfoKHR get{XR_TYPE_VULKAN_GRAPHICS_DEVICE_GET_INFO_KHR};
  get.systemId = p.system;
  get.vulkanInstance = p.vulkan;
  checkXr("xrGetVulkanGraphicsDevice2KHR",
          function<PFN_xrGetVulkanGraphicsDevice2KHR>(p.instance, "xrGetVulkanGraphicsDevice2KHR")(p.instance, &get,
                                                                                                   &p.physical));
  const float priority = 1;
  VkDeviceQueueCreateInfo queue{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  VkDeviceCreateInfo device{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
  device.queueCreateInfoCount = 1;
  device.pQueueCreateInfos = &queue;
  XrVulkanDeviceCreateInfoKHR xrDevice{XR_TYPE_VULKAN_DEVICE_CREATE_INFO_KHR};
  xrDevice.systemId = p.system;
  xrDevice.pfnGetInstanceProcAddr = &vkGetInstanceProcAddr;
  xrDevice.vulkanPhysicalDevice = p.physical;
  xrDevice.vulkanCreateInfo = &device;
  checkXr("xrCreateVulkanDeviceKHR", function<PFN_xrCreateVulkanDeviceKHR>(p.instance, "xrCreateVulkanDeviceKHR")(
                                         p.instance, &xrDevice, &p.device, &result));
  checkVk("vkCreateDevice", result);
}

std::vector<std::int64_t> formatsOf(XrSession session) {
  std::uint32_t count = 0;
  checkXr("xrEnumerateSwapchainFormats", xrEnumerateSwapchainFormats(session, 0, &count, nullptr));
  std::vector<std::int64_t> formats(count);
  checkXr("xrEnumerateSwapchainFormats", xrEnumerateSwapchainFormats(session, count, &count, formats.data()));
  return formats;
}

std::vector<int> spacesOf(XrSession session) {
  std::uint32_t count = 0;
  checkXr("xrEnumerateReferenceSpaces", xrEnumerateReferenceSpaces(session, 0, &count, nullptr));
  std::vector<XrReferenceSpaceType> types(count);
  checkXr("xrEnumerateReferenceSpaces", xrEnumerateReferenceSpaces(session, count, &count, types.data()));
  return {types.begin(), types.end()};
}

// Number of corners of the left view's hidden mesh; −1 without the extension.
int maskIndicesOf(const ProbeSession& p) {
  if (!p.visibilityMask) return -1;
  XrVisibilityMaskKHR mask{XR_TYPE_VISIBILITY_MASK_KHR};
  checkXr("xrGetVisibilityMaskKHR", function<PFN_xrGetVisibilityMaskKHR>(p.instance, "xrGetVisibilityMaskKHR")(
                                        p.session, XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO, 0,
                                        XR_VISIBILITY_MASK_TYPE_HIDDEN_TRIANGLE_MESH_KHR, &mask));
  return int(mask.indexCountOutput);
}

void makeSpaces(ProbeSession& p, const std::vector<int>& types) {
  XrReferenceSpaceCreateInfo space{XR_TYPE_REFERENCE_SPACE_CREATE_INFO};
  const bool stage = std::ranges::find(types, int(XR_REFERENCE_SPACE_TYPE_STAGE)) != types.end();
  space.referenceSpaceType = stage ? XR_REFERENCE_SPACE_TYPE_STAGE : XR_REFERENCE_SPACE_TYPE_LOCAL;
  space.poseInReferenceSpace.orientation.w = 1;
  checkXr("xrCreateReferenceSpace", xrCreateReferenceSpace(p.session, &space, &p.space));
  XrActionSpaceCreateInfo hand{XR_TYPE_ACTION_SPACE_CREATE_INFO};
  hand.action = p.hand;
  hand.poseInActionSpace.orientation.w = 1;
  checkXr("xrCreateActionSpace", xrCreateActionSpace(p.session, &hand, &p.handSpace));
}

// Creates a swapchain of two layers, or of one layer if two are refused.
int makeSwapchain(ProbeSession& p, std::int64_t format) {
  XrSwapchainCreateInfo info{XR_TYPE_SWAPCHAIN_CREATE_INFO};
  info.usageFlags = XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT;
  info.format = format;
  info.sampleCount = info.faceCount = info.mipCount = 1;
  info.width = p.width;
  info.height = p.height;
  info.arraySize = 2;
  XrResult result = xrCreateSwapchain(p.session, &info, &p.colour);
  if (result == XR_ERROR_FEATURE_UNSUPPORTED) {
    info.arraySize = 1;
    result = xrCreateSwapchain(p.session, &info, &p.colour);
  }
  checkXr("xrCreateSwapchain", result);
  return int(info.arraySize);
}

}  // namespace

void openInstance(ProbeSession& p) {
  p.depthLayer = hasExtension(XR_KHR_COMPOSITION_LAYER_DEPTH_EXTENSION_NAME);
  p.visibilityMask = hasExtension(XR_KHR_VISIBILITY_MASK_EXTENSION_NAME);
  std::vector<const char*> extensions{XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME};
  if (p.visibilityMask) extensions.push_back(XR_KHR_VISIBILITY_MASK_EXTENSION_NAME);
  XrInstanceCreateInfo info{XR_TYPE_INSTANCE_CREATE_INFO};
  std::strcpy(info.applicationInfo.applicationName, "probe");
  info.applicationInfo.apiVersion = XR_MAKE_VERSION(1, 0, 0);
  info.enabledExtensionCount = std::uint32_t(extensions.size());
  info.enabledExtensionNames = extensions.data();
  checkXr("xrCreateInstance", xrCreateInstance(&info, &p.instance));
  XrSystemGetInfo system{XR_TYPE_SYSTEM_GET_INFO};
  system.formFactor = XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY;
  checkXr("xrGetSystem", xrGetSystem(p.instance, &system, &p.system));
  std::uint32_t count = 2;
  std::array<XrViewConfigurationView, 2> views{};
  for (XrViewConfigurationView& view : views) view.type = XR_TYPE_VIEW_CONFIGURATION_VIEW;
  checkXr("xrEnumerateViewConfigurationViews",
          xrEnumerateViewConfigurationViews(p.instance, p.system, XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO, count,
                                            &count, views.data()));
  p.width = views[0].recommendedImageRectWidth;
  p.height = views[0].recommendedImageRectHeight;
  makeActions(p);
  makeDevice(p);
}

void openSession(ProbeSession& p) {
  XrGraphicsBindingVulkanKHR binding{XR_TYPE_GRAPHICS_BINDING_VULKAN2_KHR};
  binding.instance = p.vulkan;
  binding.physicalDevice = p.physical;
  binding.device = p.device;
  XrSessionCreateInfo info{XR_TYPE_SESSION_CREATE_INFO};
  info.next = &binding;
  info.systemId = p.system;
  checkXr("xrCreateSession", xrCreateSession(p.instance, &info, &p.session));
  XrSessionActionSetsAttachInfo attach{XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO};
  attach.countActionSets = 1;
  attach.actionSets = &p.actions;
  checkXr("xrAttachSessionActionSets", xrAttachSessionActionSets(p.session, &attach));
  const auto formats = formatsOf(p.session);
  const auto spaces = spacesOf(p.session);
  makeSpaces(p, spaces);
  print({{"depthLayer", p.depthLayer},
         {"visibilityMask", p.visibilityMask},
         {"formats", formats},
         {"spaces", spaces},
         {"size", {p.width, p.height}},
         {"maskIndices", maskIndicesOf(p)},
         {"layers", makeSwapchain(p, formats.at(0))}});
}

void closeSession(ProbeSession& p) {
  if (p.session) xrDestroySession(p.session);
  p.session = XR_NULL_HANDLE;
}

void closeInstance(ProbeSession& p) {
  closeSession(p);
  if (p.device) vkDestroyDevice(p.device, nullptr);
  if (p.instance) xrDestroyInstance(p.instance);
  if (p.vulkan) vkDestroyInstance(p.vulkan, nullptr);
  p = {};
}

}  // namespace ibr::test
