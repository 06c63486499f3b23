// SPDX-License-Identifier: Apache-2.0
// A Vulkan device: created by libibr, or adopted from the caller (an engine, an OpenXR runtime).
//
// A process may use several devices. Its only state is the table of Vulkan functions (Device::loadFunctions) with the
// number of devices. One thread at a time uses a Device; jobs of a GpuScene that streams photographs may use it at the
// same time. Objects made from a Device must be destroyed before it. Constructors that upload submit on its queue and
// wait, unless they get Uploads (ibr/uploads.h).
//
// Files, memory and waiting: create(), adopt(), list(), describe(), preferred(), name() and the functions that return
// lists allocate host memory; the first of them loads Vulkan's functions, which reads the loader and drivers. create()
// reads DeviceOptions::pipelineCache, ~Device waits and writes it. All other functions do nothing of this, except that
// lockQueue() waits for the lock.
//
// The queue of an adopted device: the caller synchronises its use externally, or passes a lock (DeviceHandles). With a
// lock, several threads may each adopt the same handles: one makes a GpuScene while another renders frames.
#pragma once

#include <vulkan/vulkan_core.h>

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "ibr/device_kind.h"
#include "ibr/export.h"
#include "ibr/log.h"

namespace ibr {

class DeviceAllocator;  // ibr/device_memory.h

/// Vulkan's feature structures. Call link() on the object that is passed to Vulkan; copying does not chain the copy.
struct DeviceFeatures {
  /// Features of Vulkan 1.0; head of the chain.
  VkPhysicalDeviceFeatures2 core{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
  /// Features of Vulkan 1.1.
  VkPhysicalDeviceVulkan11Features vulkan11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES};
  /// Features of Vulkan 1.2.
  VkPhysicalDeviceVulkan12Features vulkan12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
  /// Features of Vulkan 1.3.
  VkPhysicalDeviceVulkan13Features vulkan13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};

  /// Chains core → 1.1 → 1.2 → 1.3 → next and returns the head, for VkDeviceCreateInfo::pNext. The chain is valid while
  /// *this lives and is not moved.
  IBR_API const VkPhysicalDeviceFeatures2* link(void* next = nullptr);
};

/// Requirements on an adopted device, as data to merge into the caller's own create-infos.
struct DeviceRequirements {
  std::uint32_t apiVersion = 0;                 // minimum Vulkan version of instance and device
  std::vector<std::string> instanceExtensions;  // required
  std::vector<std::string> deviceExtensions;    // required
  DeviceFeatures features;                      // VK_TRUE: required
  DeviceFeatures optionalFeatures;              // VK_TRUE: used if the device has the feature
  VkQueueFlags queueFlags = 0;                  // capabilities of the one queue that is used
};

/// Options of Device::create().
struct DeviceOptions {
  std::string device;       // index or part of the name; "" = IBR_DEVICE, else discrete, integrated, CPU
  bool validation = false;  // core + synchronisation validation; throws Error{unsupported} where the layer is missing
  std::vector<std::string> instanceExtensions;  // additional, such as GLFW's surface extensions
  std::vector<std::string> deviceExtensions;    // additional, such as VK_KHR_swapchain
  LogCallback log;  // gets validation messages (errors and warnings) and the choice of device
  /// File that caches compiled pipelines between runs; empty: none. A missing file is skipped; a damaged one, or one of
  /// another device or driver, is ignored and logged. If the cache has changed, ~Device replaces the file atomically;
  /// its folder must exist. Write errors go to the log, which must outlive the device.
  std::filesystem::path pipelineCache;
  /// Optional features to leave disabled although the device has them, to emulate a weaker device. Names from
  /// Device::optionalFeatureNames(), separated by commas; "" = IBR_DISABLE_FEATURES. Throws Error{invalidInput} for an
  /// unknown name.
  std::string disabledFeatures;
  DeviceAllocator* allocator = nullptr;  // source of device memory; null: vkAllocateMemory for each buffer and image
};

/// Borrowed handles; the caller keeps ownership. The device must have been created with all of Device::requirements().
///
/// The lock of the queue is either a mutex or a pair of callbacks. It is held while libibr submits to the queue or
/// waits for the queue, and at no other time: not during recording, not while waiting for a fence. These calls submit
/// or wait: constructors that upload (GpuScene, Renderer, GpuHtmModel, …), Offscreen::render, align() and other
/// functions that return results of the device. Calls that only record never take the lock: Renderer::record,
/// GpuScene::stream, ScopeTimer. The callbacks run in pairs on the calling thread. They must not throw or call libibr.
struct DeviceHandles {
  VkInstance instance = VK_NULL_HANDLE;              // instance of `physicalDevice`
  VkPhysicalDevice physicalDevice = VK_NULL_HANDLE;  // physical device of `device`
  VkDevice device = VK_NULL_HANDLE;                  // device to use
  VkQueue queue = VK_NULL_HANDLE;                    // queue of `device`, the only one that libibr submits to
  std::uint32_t queueFamily = 0;                     // family of `queue`, with DeviceRequirements::queueFlags
  DeviceFeatures optionalFeatures;  // VK_TRUE for those of requirements().optionalFeatures that were enabled
  LogCallback log;                  // gets the name of the device
  VkPipelineCache pipelineCache = VK_NULL_HANDLE;                  // optional; pipelines are created with it
  std::mutex* queueMutex = nullptr;                                // null and no callbacks: one thread uses the queue
  std::function<void()> lockQueue, unlockQueue;                    // both or none; not together with queueMutex
  const std::atomic<std::uint64_t>* validationMessages = nullptr;  // optional; counted by the caller's messenger
  DeviceAllocator* allocator = nullptr;                            // as DeviceOptions::allocator
};

/// Returns DeviceKind::software for VK_PHYSICAL_DEVICE_TYPE_CPU, else DeviceKind::hardware.
constexpr DeviceKind deviceKindOf(VkPhysicalDeviceType type) noexcept {
  return type == VK_PHYSICAL_DEVICE_TYPE_CPU ? DeviceKind::software : DeviceKind::hardware;
}

/// A physical device, as `ibr doctor` lists it.
struct DeviceDescription {
  std::string name, driver;      // name: of the device; driver: name and version of its driver; both for people
  std::uint32_t apiVersion = 0;  // highest Vulkan version that the device supports (VK_MAKE_API_VERSION)
  VkPhysicalDeviceType type = VK_PHYSICAL_DEVICE_TYPE_OTHER;  // integrated, discrete, virtual or CPU
  std::uint64_t memoryBytes = 0;                              // sum of the device-local heaps, bytes
  std::vector<std::string> features;         // its optional features (Device::optionalFeatureNames()), disabled or not
  std::vector<std::string> missing;          // missing requirements; empty: libibr can use the device
  std::optional<std::uint32_t> queueFamily;  // first one that meets the requirements
};

/// A Vulkan device with the one queue that libibr uses. Lifetime, threads and waiting: ibr/device.h.
class IBR_API Device {
 public:
  /// Makes libibr call the caller's Vulkan functions, as getInstanceProcAddr(instance, name) returns them. Without this
  /// call, they are loaded from libvulkan.so.1 when first needed. libibr references no symbol of the loader, so that a
  /// program may define pointers with the names of its functions (volk). The functions must serve all instances and
  /// devices of the process, as those of the loader do. `instance` VK_NULL_HANDLE: loads only what creates an instance;
  /// create(), list() and adopt() then load the rest from their first instance.
  ///
  /// Call while no Device exists and no other thread uses libibr. Throws Error{invalidInput} if a Device exists or the
  /// function is null; Error{unsupported}, which names the first missing function. The functions then stay as they
  /// were.
  static void loadFunctions(PFN_vkGetInstanceProcAddr getInstanceProcAddr, VkInstance instance = VK_NULL_HANDLE);

  /// Creates an instance and a device. Throws Error{unsupported}, which names for each physical device the reason for
  /// its rejection, or the missing loader; Error{invalidInput} as DeviceOptions::disabledFeatures says.
  static Device create(const DeviceOptions& options = {});

  /// Borrows the handles and never destroys them. Features that IBR_DISABLE_FEATURES names are not used. Throws
  /// Error{unsupported} where the device is found to lack a requirement, Error{invalidInput} for a null handle, half a
  /// pair of callbacks, or a mutex beside them; Error{unsupported} where Vulkan's functions cannot be loaded.
  static Device adopt(const DeviceHandles& handles);

  /// Returns the requirements that a device for adopt() must meet.
  static DeviceRequirements requirements();
  /// Returns the physical devices in the order in which Vulkan enumerates them. Empty where libibr can use no loader or
  /// driver: create() throws the reason.
  static std::vector<DeviceDescription> list();
  /// Returns the description of a physical device. Throws Error{invalidInput} if loadFunctions() had no instance and
  /// none has been used, Error{unsupported} where Vulkan's functions cannot be loaded.
  static DeviceDescription describe(VkPhysicalDevice device);
  /// Returns the features to enable on a device that lacks nothing: those required, and the optional ones that the
  /// device has and IBR_DISABLE_FEATURES does not name. Throws as describe().
  static DeviceFeatures featuresFor(VkPhysicalDevice device);
  /// Returns the device of list() that create() takes if DeviceOptions::device is `selector`; none where create() would
  /// throw.
  static std::optional<DeviceDescription> preferred(const std::string& selector = {});

  /// Returns the names of the optional features.
  static std::vector<std::string> optionalFeatureNames();
  /// Splits a list as DeviceOptions::disabledFeatures has it; "" = IBR_DISABLE_FEATURES. Throws Error{invalidInput} for
  /// an unknown name.
  static std::vector<std::string> disabledFeatures(const std::string& list = {});

  Device(Device&&) noexcept;
  Device& operator=(Device&&) noexcept;
  ~Device();  // waits until an owned device is idle; an adopted device is left alone

  VkInstance instance() const noexcept;              // made by create(), or the caller's
  VkPhysicalDevice physicalDevice() const noexcept;  // chosen by create(), or the caller's
  VkDevice handle() const noexcept;                  // made by create(), or the caller's
  VkQueue queue() const noexcept;                    // the queue that libibr submits to
  std::uint32_t queueFamily() const noexcept;        // index of the family of queue()
  /// Takes the lock of DeviceHandles, for the caller's own use of queue(). Not recursive. No effect on a device without
  /// a lock.
  void lockQueue() const;
  /// Releases the lock that lockQueue() took.
  void unlockQueue() const;
  /// Returns the cache that all pipelines are created with; VK_NULL_HANDLE where an adopted device came without one.
  VkPipelineCache pipelineCache() const noexcept;
  /// Returns DeviceOptions::allocator or DeviceHandles::allocator; may be null.
  DeviceAllocator* allocator() const noexcept;
  const VkPhysicalDeviceProperties& properties() const noexcept;              // properties of the physical device
  const VkPhysicalDeviceMemoryProperties& memoryProperties() const noexcept;  // heaps and types of its memory
  /// Returns true if BC1 and BC7 textures can be sampled: the optional feature textureCompressionBC.
  bool supportsBlockCompression() const noexcept;
  bool supportsInt64() const noexcept;         // the optional feature shaderInt64
  bool supportsInt64Atomics() const noexcept;  // both shaderInt64 and shaderBufferInt64Atomics
  /// Returns true if the feature multiview is enabled: one pass may draw several views. Some drivers claim it and draw
  /// wrongly.
  bool supportsMultiview() const noexcept;
  DeviceKind kind() const noexcept;  // by the type of the physical device
  std::string name() const;          // device and driver version, for people

  /// Returns true after a call has found the device lost, or after markLost(). From then on, creating objects from the
  /// device and submitting to it throws Error{deviceLost}. May be called from any thread.
  bool isLost() const noexcept;
  /// Marks the device as lost. Call it if your own submission of libibr's commands fails with VK_ERROR_DEVICE_LOST. May
  /// be called from any thread.
  void markLost() const noexcept;

  /// Returns the number of messages from the validation layer (0 without validation); on an adopted device, the
  /// caller's count. Tests require 0.
  std::uint64_t validationMessages() const noexcept;

  /// Returns a number that grows by 1 whenever a ShaderReloader (ibr/shader_reload.h) replaces or restores shaders.
  /// Objects made before keep their pipelines; objects made afterwards use the new shaders.
  std::uint64_t shaderGeneration() const noexcept;

  struct IBR_LOCAL State;

 private:
  friend State& stateOf(const Device& device) noexcept;
  explicit Device(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace ibr
