// SPDX-License-Identifier: Apache-2.0
#include "gpu/instance.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "base/check.h"
#include "gpu/vulkan.h"

namespace ibr {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

std::vector<VkExtensionProperties> extensionsOf(const char* layer) {
  std::uint32_t count = 0;
  vk(vkEnumerateInstanceExtensionProperties(layer, &count, nullptr), "vkEnumerateInstanceExtensionProperties");
  std::vector<VkExtensionProperties> extensions(count);
  vk(vkEnumerateInstanceExtensionProperties(layer, &count, extensions.data()),
     "vkEnumerateInstanceExtensionProperties");
  return extensions;
}

bool hasExtension(const std::vector<VkExtensionProperties>& extensions, std::string_view name) {
  return std::any_of(extensions.begin(), extensions.end(), [&](const auto& e) { return name == e.extensionName; });
}

bool hasValidationLayer() {
  std::uint32_t count = 0;
  vk(vkEnumerateInstanceLayerProperties(&count, nullptr), "vkEnumerateInstanceLayerProperties");
  std::vector<VkLayerProperties> layers(count);
  vk(vkEnumerateInstanceLayerProperties(&count, layers.data()), "vkEnumerateInstanceLayerProperties");
  return std::any_of(layers.begin(), layers.end(),
                     [](const auto& layer) { return std::string_view(layer.layerName) == kValidationLayer; });
}

VKAPI_ATTR VkBool32 VKAPI_CALL receive(VkDebugUtilsMessageSeverityFlagBitsEXT severity, VkDebugUtilsMessageTypeFlagsEXT,
                                       const VkDebugUtilsMessengerCallbackDataEXT* data, void* messages) {
  try {
    const LogLevel level =
        severity >= VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT ? LogLevel::error : LogLevel::warning;
    static_cast<Messages*>(messages)->sendValidation(
        level, fmt::format("Vulkan validation, {}: {}", data->pMessageIdName ? data->pMessageIdName : "no id",
                           data->pMessage));
  } catch (...) {
    // An exception of the caller's log must not cross the layer; the message is counted all the same.
  }
  return VK_FALSE;
}

}  // namespace

Messages::Messages(LogCallback log) : log_(std::move(log)) {}

void Messages::send(LogLevel level, std::string_view text) {
  const std::lock_guard lock(mutex_);
  if (log_) log_(level, text);
}

void Messages::sendValidation(LogLevel level, std::string_view text) {
  ++validationMessages_;
  send(level, text);
}

Instance::Instance(std::span<const std::string> extensions, bool validation, Messages& messages) {
  const auto available = extensionsOf(nullptr);
  std::vector<const char*> enabled;
  for (const std::string& name : extensions) {
    check(hasExtension(available, name), ErrorCode::unsupported, "Vulkan has no instance extension {} here", name);
    enabled.push_back(name.c_str());
  }
  const bool debugUtils = hasExtension(available, VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
  if (debugUtils) enabled.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);

  const VkDebugUtilsMessengerCreateInfoEXT messengerInfo{
      .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
      .messageSeverity =
          VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
      // Not GENERAL: in it the loader tells of other people's drivers and layers.
      .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT,
      .pfnUserCallback = receive,
      .pUserData = &messages};
  constexpr VkValidationFeatureEnableEXT kEnabled[]{VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
  const VkValidationFeaturesEXT features{.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
                                         .pNext = &messengerInfo,  // for messages of creation and destruction
                                         .enabledValidationFeatureCount = 1,
                                         .pEnabledValidationFeatures = kEnabled};
  if (validation) {
    check(debugUtils && hasValidationLayer(), ErrorCode::unsupported,
          "validation is asked for, but {} is not installed (Debian: vulkan-validationlayers)", kValidationLayer);
    check(hasExtension(extensionsOf(kValidationLayer), VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME),
          ErrorCode::unsupported, "{} is too old: it has no {}", kValidationLayer,
          VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME);
    enabled.push_back(VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME);
  }

  const VkApplicationInfo application{
      .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .pEngineName = "libibr", .apiVersion = VK_API_VERSION_1_3};
  const VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                  .pNext = validation ? &features : nullptr,
                                  .pApplicationInfo = &application,
                                  .enabledLayerCount = validation ? 1u : 0u,
                                  .ppEnabledLayerNames = &kValidationLayer,
                                  .enabledExtensionCount = std::uint32_t(enabled.size()),
                                  .ppEnabledExtensionNames = enabled.data()};
  const VkResult result = vkCreateInstance(&info, nullptr, &instance_);
  check(result != VK_ERROR_INCOMPATIBLE_DRIVER, ErrorCode::unsupported,
        "no Vulkan driver is installed (Debian: mesa-vulkan-drivers has one that needs no GPU)");
  vk(result, "vkCreateInstance");
  if (!validation) return;

  const auto createMessenger = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
      vkGetInstanceProcAddr(instance_, "vkCreateDebugUtilsMessengerEXT"));
  const VkResult messengerResult = createMessenger(instance_, &messengerInfo, nullptr, &messenger_);
  if (messengerResult != VK_SUCCESS) vkDestroyInstance(std::exchange(instance_, VK_NULL_HANDLE), nullptr);
  vk(messengerResult, "vkCreateDebugUtilsMessengerEXT");
}

Instance::~Instance() {
  if (messenger_) {
    const auto destroyMessenger = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
        vkGetInstanceProcAddr(instance_, "vkDestroyDebugUtilsMessengerEXT"));
    destroyMessenger(instance_, messenger_, nullptr);
  }
  if (instance_) vkDestroyInstance(instance_, nullptr);
}

}  // namespace ibr
