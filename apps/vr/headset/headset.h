// SPDX-License-Identifier: Apache-2.0
// An OpenXR instance, its headset, and the Vulkan device that the runtime requires (XR_KHR_vulkan_enable2). If any is
// lost, create a new Headset. Threading: one thread, except for `device`.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "base/vulkan/functions.h"
#include "base/vulkan/pipeline_cache.h"
#include "base/vulkan/validation.h"
#include "ibr/device.h"
#include "vr/headset/openxr.h"

namespace ibr::app {

struct HeadsetOptions {
  bool validation = false;                      // Vulkan validation layers
  std::vector<std::string> instanceExtensions;  // additional Vulkan extensions, such as a window's
  std::vector<std::string> deviceExtensions;    // additional; enabled if the device has all of them
  std::filesystem::path pipelineCache;          // file, as DeviceOptions::pipelineCache; empty: none
  LogCallback log;                              // called from any thread
  std::atomic<std::uint64_t>* messages =
      nullptr;  // counts validation messages, except for messages that the runtime itself causes
};

class Headset {
 public:
  /// Throws Error{unsupported} that names what is missing: a runtime, a headset, Vulkan.
  explicit Headset(const HeadsetOptions& options);
  Headset(const Headset&) = delete;
  Headset& operator=(const Headset&) = delete;

  XrInstance instance() const noexcept { return instance_.get(); }
  XrSystemId system() const noexcept { return system_; }
  std::string name() const { return name_; }  // of headset and runtime, for people

  // Enabled extensions.
  bool supportsDepthLayer() const noexcept { return supportsDepthLayer_; }          // XR_KHR_composition_layer_depth
  bool supportsVisibilityMask() const noexcept { return supportsVisibilityMask_; }  // XR_KHR_visibility_mask

  /// Graphics binding for a session.
  XrGraphicsBindingVulkan2KHR binding() const noexcept;

  /// Adopts the device; each thread needs its own Device. All lock the queue. The headset must outlive them.
  Device device(LogCallback log);
  std::mutex& queueMutex() noexcept { return queueMutex_; }
  bool hasDeviceExtensions() const noexcept { return hasExtensions_; }  // all of HeadsetOptions::deviceExtensions

 private:
  LogCallback counting(const HeadsetOptions& options);
  void makeInstance();
  void findSystem();
  void makeVulkanInstance(const HeadsetOptions& options);
  void makeVulkanDevice(const HeadsetOptions& options);

  std::atomic<bool> runtimeMessageReported_{false};
  Messages messages_;
  XrInstanceOwner instance_;
  XrSystemId system_ = XR_NULL_SYSTEM_ID;
  std::string name_;
  bool supportsDepthLayer_ = false, supportsVisibilityMask_ = false, hasExtensions_ = false;
  struct DestroyInstance {
    void operator()(VkInstance instance) const noexcept { vkDestroyInstance(instance, nullptr); }
  };
  struct DestroyDevice {
    void operator()(VkDevice device) const noexcept { vkDestroyDevice(device, nullptr); }
  };
  std::unique_ptr<VkInstance_T, DestroyInstance> vulkan_;
  std::optional<Messenger> messenger_;
  VkPhysicalDevice physicalDevice_ = VK_NULL_HANDLE;
  std::unique_ptr<VkDevice_T, DestroyDevice> device_;
  VkQueue queue_ = VK_NULL_HANDLE;
  std::uint32_t queueFamily_ = 0;
  std::optional<PipelineCache> pipelines_;
  DeviceFeatures optionalFeatures_;  // enabled
  std::mutex queueMutex_;
};

}  // namespace ibr::app
