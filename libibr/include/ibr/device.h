// SPDX-License-Identifier: Apache-2.0
// A Vulkan device: made by us, or borrowed from the caller (an engine, an OpenXR runtime).
//
// No global state; several devices in one process work. A Device is used by one thread at a time, and everything made
// from it is destroyed before it. The caller externally synchronises the queue of an adopted device, or gives a mutex:
// then several threads may each adopt the same handles, and one makes a GpuScene while another goes on with frames.
#pragma once

#include <vulkan/vulkan_core.h>

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "ibr/log.h"

namespace ibr {

struct ShaderReplacements;

/// Vulkan's feature structures, chained on demand. Copies are unchained: call `link` on the object that is passed on.
struct DeviceFeatures {
  VkPhysicalDeviceFeatures2 core{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
  VkPhysicalDeviceVulkan11Features vulkan11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES};
  VkPhysicalDeviceVulkan12Features vulkan12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
  VkPhysicalDeviceVulkan13Features vulkan13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};

  /// Chains core → 1.1 → 1.2 → 1.3 → next and returns the head, for VkDeviceCreateInfo::pNext. Valid while *this lives
  /// and is not moved.
  const VkPhysicalDeviceFeatures2* link(void* next = nullptr);
};

/// What libibr needs of a device that it did not make, as data to merge into the caller's own create-infos.
struct DeviceRequirements {
  std::uint32_t apiVersion = 0;                 // of instance and device, at least
  std::vector<std::string> instanceExtensions;  // required
  std::vector<std::string> deviceExtensions;    // required
  DeviceFeatures features;                      // VK_TRUE where required
  DeviceFeatures optionalFeatures;              // VK_TRUE where libibr makes use of it if the device has it
  VkQueueFlags queueFlags = 0;                  // of the one queue used
};

struct DeviceOptions {
  std::string device;       // index or part of the name; "" = IBR_DEVICE, else discrete, integrated, CPU
  bool validation = false;  // core + synchronisation validation; throws Error{unsupported} where the layer is missing
  std::vector<std::string> instanceExtensions;  // further ones, such as GLFW's surface extensions
  std::vector<std::string> deviceExtensions;    // further ones, such as VK_KHR_swapchain
  LogCallback log;                              // validation messages (errors and warnings) and the choice of device
  /// Where compiled pipelines are kept for the next start; empty: nowhere. Read where it is there and of this device
  /// and driver, else ignored and the log told; written whole as the device goes, in a folder that must be there. What
  /// fails then is told to the log, which must outlive the device.
  std::filesystem::path pipelineCache;
  /// Optional features to leave alone though the device has them, as if it were a lesser one: names of
  /// Device::optionalFeatureNames(), separated by commas; "" = IBR_DISABLE_FEATURES. Another name is an
  /// Error{invalidInput}.
  std::string disabledFeatures;
};

/// Borrowed handles; all stay the caller's. The device was made with everything that requirements() names.
struct DeviceHandles {
  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physicalDevice = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  std::uint32_t queueFamily = 0;
  DeviceFeatures optionalFeatures;  // VK_TRUE for those of requirements().optionalFeatures that were enabled
  LogCallback log;
  VkPipelineCache pipelineCache = VK_NULL_HANDLE;  // the caller's own, if any: pipelines are made with it
  std::mutex* queueMutex = nullptr;                // held around every use of the queue; null: one thread uses it
  const std::atomic<std::uint64_t>* validationMessages = nullptr;  // counted by the caller's messenger, if any
};

/// What a device computes with; presets differ by it.
enum class DeviceKind : std::uint8_t {
  software,  // the processor: VK_PHYSICAL_DEVICE_TYPE_CPU
  hardware,  // all other types
};
constexpr DeviceKind kindOf(VkPhysicalDeviceType type) noexcept {
  return type == VK_PHYSICAL_DEVICE_TYPE_CPU ? DeviceKind::software : DeviceKind::hardware;
}

/// A physical device as `ibr device` lists it.
struct DeviceDescription {
  std::string name, driver;
  std::uint32_t apiVersion = 0;
  VkPhysicalDeviceType type = VK_PHYSICAL_DEVICE_TYPE_OTHER;
  std::uint64_t memoryBytes = 0;      // device-local
  std::vector<std::string> features;  // of Device::optionalFeatureNames(), disabled or not
  std::vector<std::string> lacking;   // why libibr cannot use it; empty: it can
};

class Device {
 public:
  /// Makes instance and device. Throws Error{unsupported} that names, for each physical device, why it was rejected.
  static Device create(const DeviceOptions& options = {});

  /// Borrows; never destroys what it borrows. What IBR_DISABLE_FEATURES names is not used. Throws Error{unsupported}
  /// where the device is seen to lack something.
  static Device adopt(const DeviceHandles& handles);

  static DeviceRequirements requirements();
  static std::vector<DeviceDescription> list();
  /// The one of `list` that `create` takes if DeviceOptions::device is `wish`; none where `create` would throw.
  static std::optional<DeviceDescription> preferred(const std::string& wish = {});

  /// Names of what libibr makes use of where the device has it; and those of a list as DeviceOptions::disabledFeatures
  /// has it. Throws Error{invalidInput} for a name that is none.
  static std::vector<std::string> optionalFeatureNames();
  static std::vector<std::string> disabledFeatures(const std::string& list = {});

  Device(Device&&) noexcept;
  Device& operator=(Device&&) noexcept;
  ~Device();  // waits until an owned device is idle; an adopted one is left alone

  VkInstance instance() const noexcept;
  VkPhysicalDevice physicalDevice() const noexcept;
  VkDevice handle() const noexcept;
  VkQueue queue() const noexcept;
  std::uint32_t queueFamily() const noexcept;
  /// What is held around every use of the queue of an adopted device, as it was given; else null.
  std::mutex* queueMutex() const noexcept;
  /// What all pipelines are made with; VK_NULL_HANDLE where an adopted device came without one.
  VkPipelineCache pipelineCache() const noexcept;
  const VkPhysicalDeviceProperties& properties() const noexcept;
  const VkPhysicalDeviceMemoryProperties& memoryProperties() const noexcept;
  /// Whether pictures in blocks (BC1, BC7) can be sampled: the feature textureCompressionBC, which is optional.
  bool samplesBlocks() const noexcept;
  /// Whether shaders count in 64 bits (shaderInt64), and whether they do so together (shaderBufferInt64Atomics).
  bool counts64Bits() const noexcept;
  bool countsTogether64Bits() const noexcept;
  /// Whether one pass may draw several views: the feature multiview, which not every device does right.
  bool drawsViewsTogether() const noexcept;
  DeviceKind kind() const noexcept;
  std::string name() const;  // as a person would cite it: device and driver version

  /// Whether a call has found the device lost, or its owner has said so by `lose` (who submits what libibr recorded
  /// finds out first). From then on whatever is made from it, or given to it, throws Error{deviceLost}. Any thread.
  bool isLost() const noexcept;
  void lose() const noexcept;

  /// How many messages the validation layer has sent so far (0 without validation), of an adopted device as the caller
  /// counts them. Tests demand 0.
  std::uint64_t validationMessages() const noexcept;

  /// Raised whenever a ShaderReloader (ibr/shader_reload.h) replaces shaders or takes some back: what was made from
  /// this device before goes on with its own pipelines, what is made from now on has the new ones.
  std::uint64_t shaderGeneration() const noexcept;

 private:
  friend ShaderReplacements& shaderReplacements(Device& device) noexcept;
  friend const ShaderReplacements& shaderReplacements(const Device& device) noexcept;
  struct State;
  explicit Device(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace ibr
