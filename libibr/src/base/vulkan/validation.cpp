// SPDX-License-Identifier: Apache-2.0
#include "base/vulkan/validation.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "base/check.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/vulkan.h"

namespace ibr {
namespace {

constexpr VkValidationFeatureEnableEXT kSynchronisation = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;

bool hasValidationLayer() {
  std::uint32_t count = 0;
  vk(vkEnumerateInstanceLayerProperties(&count, nullptr), "vkEnumerateInstanceLayerProperties");
  std::vector<VkLayerProperties> layers(count);
  vk(vkEnumerateInstanceLayerProperties(&count, layers.data()), "vkEnumerateInstanceLayerProperties");
  return std::any_of(layers.begin(), layers.end(),
                     [](const auto& layer) { return std::string_view(layer.layerName) == Validation::kLayer; });
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
    // An exception of the caller's log must not cross the layer; the message is counted anyway.
  }
  return VK_FALSE;
}

VkDebugUtilsMessengerCreateInfoEXT messengerInfo(Messages& messages) {
  return {
      .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
      .messageSeverity =
          VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
      // Not GENERAL: those messages are about drivers and layers of others.
      .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT,
      .pfnUserCallback = receive,
      .pUserData = &messages};
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

Validation::Validation(Messages& messages)
    : messenger_(messengerInfo(messages)),
      features_{.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
                .pNext = &messenger_,
                .enabledValidationFeatureCount = 1,
                .pEnabledValidationFeatures = &kSynchronisation} {
  check(hasInstanceExtension(VK_EXT_DEBUG_UTILS_EXTENSION_NAME) && hasValidationLayer(), ErrorCode::unsupported,
        "validation is requested, but {} is not installed (Debian: install vulkan-validationlayers)", kLayer);
  check(hasInstanceExtension(VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME, kLayer), ErrorCode::unsupported,
        "{} is too old: extension {} is missing", kLayer, VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME);
}

Messenger::Messenger(VkInstance instance, Messages& messages) : instance_(instance) {
  const auto create = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
      vkGetInstanceProcAddr(instance, "vkCreateDebugUtilsMessengerEXT"));
  const VkDebugUtilsMessengerCreateInfoEXT info = messengerInfo(messages);
  vk(create(instance, &info, nullptr, &messenger_), "vkCreateDebugUtilsMessengerEXT");
}

Messenger::~Messenger() {
  const auto destroy = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
      vkGetInstanceProcAddr(instance_, "vkDestroyDebugUtilsMessengerEXT"));
  destroy(instance_, messenger_, nullptr);
}

}  // namespace ibr
