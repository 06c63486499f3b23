// SPDX-License-Identifier: Apache-2.0
#include "ibr/device.h"

#include <fmt/ranges.h>

#include <optional>
#include <utility>

#include "base/check.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/pipeline_cache.h"
#include "base/vulkan/shader_replacements.h"
#include "base/vulkan/vulkan.h"
#include "gpu/device/device_choice.h"
#include "gpu/device/instance.h"
#include "gpu/device/multiview_answer.h"

namespace ibr {
namespace {

std::atomic<int> deviceCount = 0;  // devices of the process: the functions must not change while there are any

struct Counted {
  Counted() { ++deviceCount; }
  Counted(const Counted&) = delete;
  Counted& operator=(const Counted&) = delete;
  ~Counted() { --deviceCount; }
};

void checkHandles(const DeviceHandles& handles) {
  check(handles.instance && handles.physicalDevice && handles.device && handles.queue, ErrorCode::invalidInput,
        "the device cannot be adopted: handle '{}' is null",
        !handles.instance         ? "instance"
        : !handles.physicalDevice ? "physicalDevice"
        : !handles.device         ? "device"
                                  : "queue");
  check(!handles.lockQueue == !handles.unlockQueue, ErrorCode::invalidInput,
        "the device cannot be adopted: lockQueue and unlockQueue must be set together");
  check(!handles.lockQueue || !handles.queueMutex, ErrorCode::invalidInput,
        "the device cannot be adopted: queueMutex and lockQueue are both set");
}

}  // namespace

struct Device::State {
  explicit State(LogCallback log) : messages(std::move(log)) {}
  State(const DeviceOptions& options, std::span<const std::string> extensions)
      : messages(options.log), owned(extensions, options.validation, messages), instance(owned.get()) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (!owned.get() || !device) return;
    vkDeviceWaitIdle(device);  // a lost device is idle too
    ownedCache.reset();
    vkDestroyDevice(device, nullptr);
  }

  void describeDevice() {
    vkGetPhysicalDeviceProperties(physicalDevice, &properties);
    vkGetPhysicalDeviceMemoryProperties(physicalDevice, &memory);
    const DeviceDescription description = ibr::describe(physicalDevice);
    name = fmt::format("{}, {}", description.name, description.driver);
  }

  Counted counted;
  Messages messages;
  Instance owned;  // null if the instance is borrowed
  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physicalDevice = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  std::uint32_t queueFamily = 0;
  std::function<void()> lockQueue, unlockQueue;                                           // both or none
  const std::atomic<std::uint64_t>* validationMessages = &messages.validationMessages();  // or the caller's
  std::optional<PipelineCache> ownedCache;
  VkPipelineCache pipelineCache = VK_NULL_HANDLE;  // owned or borrowed
  DeviceAllocator* allocator = nullptr;
  std::optional<bool> multiviewWorks;  // probed by gpu/draw/multiview.h
  VkPhysicalDeviceProperties properties{};
  VkPhysicalDeviceMemoryProperties memory{};
  DeviceFeatures features;  // enabled features, as far as known for an adopted device
  std::string name;
  ShaderReplacements shaders;
  std::atomic<bool> lost = false;
};

void Device::loadFunctions(PFN_vkGetInstanceProcAddr getInstanceProcAddr, VkInstance instance) {
  check(deviceCount == 0, ErrorCode::invalidInput, "Vulkan's functions cannot change while a device exists");
  ibr::loadFunctions(getInstanceProcAddr, instance);
}

Device Device::create(const DeviceOptions& options) {
  DeviceRequirements requirements = Device::requirements();
  std::vector<std::string> instanceExtensions = requirements.instanceExtensions;
  instanceExtensions.insert(instanceExtensions.end(), options.instanceExtensions.begin(),
                            options.instanceExtensions.end());
  auto state = std::make_unique<State>(options, instanceExtensions);
  const std::vector<VkPhysicalDevice> devices = physicalDevices(state->instance);
  std::vector<DeviceDescription> descriptions;
  for (const VkPhysicalDevice device : devices) descriptions.push_back(ibr::describe(device, options.deviceExtensions));
  state->physicalDevice = devices[choose(descriptions, options.device)];
  state->queueFamily = ibr::queueFamily(state->physicalDevice).value();
  state->describeDevice();

  std::vector<const char*> extensions;
  for (const std::string& name : requirements.deviceExtensions) extensions.push_back(name.c_str());
  for (const std::string& name : options.deviceExtensions) extensions.push_back(name.c_str());
  DeviceFeatures features = requirements.features;
  addOptionalFeatures(state->physicalDevice, features, options.disabledFeatures);
  state->features = features;
  const float priority = 1.0f;
  const VkDeviceQueueCreateInfo queueInfo{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                          .queueFamilyIndex = state->queueFamily,
                                          .queueCount = 1,
                                          .pQueuePriorities = &priority};
  const VkDeviceCreateInfo info{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                .pNext = features.link(),
                                .queueCreateInfoCount = 1,
                                .pQueueCreateInfos = &queueInfo,
                                .enabledExtensionCount = std::uint32_t(extensions.size()),
                                .ppEnabledExtensionNames = extensions.data()};
  vk(vkCreateDevice(state->physicalDevice, &info, nullptr, &state->device), "vkCreateDevice");
  vkGetDeviceQueue(state->device, state->queueFamily, 0, &state->queue);
  state->ownedCache.emplace(state->device, state->properties, options.pipelineCache, state->messages);
  state->pipelineCache = state->ownedCache->get();
  state->allocator = options.allocator;
  state->messages.send(LogLevel::info, fmt::format("Vulkan device: {}", state->name));
  return Device(std::move(state));
}

Device Device::adopt(const DeviceHandles& handles) {
  checkHandles(handles);
  ensureFunctions(handles.instance);
  DeviceDescription description = ibr::describe(handles.physicalDevice);
  for (std::string& lack : missingQueueCapabilities(handles.physicalDevice, handles.queueFamily))
    description.missing.push_back(std::move(lack));
  // Vulkan cannot report enabled features, but a device created for an older version lacks this function.
  if (description.missing.empty() && !vkGetDeviceProcAddr(handles.device, "vkCmdPipelineBarrier2"))
    description.missing.emplace_back("Vulkan 1.3 (created for an older version)");
  check(description.missing.empty(), ErrorCode::unsupported, "the device '{}' cannot be adopted: it lacks {}",
        description.name, fmt::join(description.missing, ", "));

  auto state = std::make_unique<State>(handles.log);
  state->instance = handles.instance;
  state->physicalDevice = handles.physicalDevice;
  state->device = handles.device;
  state->queue = handles.queue;
  state->queueFamily = handles.queueFamily;
  state->lockQueue = handles.lockQueue;
  state->unlockQueue = handles.unlockQueue;
  if (std::mutex* mutex = handles.queueMutex) {
    state->lockQueue = [mutex] { mutex->lock(); };
    state->unlockQueue = [mutex] { mutex->unlock(); };
  }
  if (handles.validationMessages) state->validationMessages = handles.validationMessages;
  state->pipelineCache = handles.pipelineCache;
  state->allocator = handles.allocator;
  state->features = handles.optionalFeatures;
  removeFeatures(state->features);
  state->describeDevice();
  state->messages.send(LogLevel::info, fmt::format("Vulkan device, adopted: {}", state->name));
  return Device(std::move(state));
}

std::vector<DeviceDescription> Device::list() {
  Messages messages{LogCallback()};
  try {
    const Instance instance({}, false, messages);
    std::vector<DeviceDescription> descriptions;
    for (const VkPhysicalDevice device : physicalDevices(instance.get())) descriptions.push_back(ibr::describe(device));
    return descriptions;
  } catch (const Error& error) {
    if (error.code() == ErrorCode::unsupported) return {};  // no driver
    throw;
  }
}

std::optional<DeviceDescription> Device::preferred(const std::string& selector) {
  const std::vector<DeviceDescription> descriptions = list();
  try {
    return descriptions[choose(descriptions, selector)];
  } catch (const Error& error) {
    if (error.code() == ErrorCode::unsupported) return std::nullopt;
    throw;
  }
}

Device::Device(std::unique_ptr<State> state) : state_(std::move(state)) {}
Device::Device(Device&&) noexcept = default;
Device& Device::operator=(Device&&) noexcept = default;
Device::~Device() = default;

VkInstance Device::instance() const noexcept {
  return state_->instance;
}
VkPhysicalDevice Device::physicalDevice() const noexcept {
  return state_->physicalDevice;
}
VkDevice Device::handle() const noexcept {
  return state_->device;
}
VkQueue Device::queue() const noexcept {
  return state_->queue;
}
std::uint32_t Device::queueFamily() const noexcept {
  return state_->queueFamily;
}
void Device::lockQueue() const {
  if (state_->lockQueue) state_->lockQueue();
}
void Device::unlockQueue() const {
  if (state_->unlockQueue) state_->unlockQueue();
}
VkPipelineCache Device::pipelineCache() const noexcept {
  return state_->pipelineCache;
}
DeviceAllocator* Device::allocator() const noexcept {
  return state_->allocator;
}
const VkPhysicalDeviceProperties& Device::properties() const noexcept {
  return state_->properties;
}
const VkPhysicalDeviceMemoryProperties& Device::memoryProperties() const noexcept {
  return state_->memory;
}
bool Device::supportsBlockCompression() const noexcept {
  return state_->features.core.features.textureCompressionBC;
}
bool Device::supportsInt64() const noexcept {
  return state_->features.core.features.shaderInt64;
}
bool Device::supportsInt64Atomics() const noexcept {
  return supportsInt64() && state_->features.vulkan12.shaderBufferInt64Atomics;
}
bool Device::supportsMultiview() const noexcept {
  return state_->features.vulkan11.multiview;
}
DeviceKind Device::kind() const noexcept {
  return deviceKindOf(state_->properties.deviceType);
}
std::string Device::name() const {
  return state_->name;
}
bool Device::isLost() const noexcept {
  return state_->lost;
}

void Device::markLost() const noexcept {
  state_->lost = true;
}

std::uint64_t Device::validationMessages() const noexcept {
  return *state_->validationMessages;
}
std::uint64_t Device::shaderGeneration() const noexcept {
  return state_->shaders.generation;
}

Device::State& stateOf(const Device& device) noexcept {
  return *device.state_;
}

std::optional<bool>& multiviewAnswer(const Device& device) noexcept {
  return stateOf(device).multiviewWorks;
}

ShaderReplacements& shaderReplacements(Device& device) noexcept {
  return stateOf(device).shaders;
}
const ShaderReplacements& shaderReplacements(const Device& device) noexcept {
  return stateOf(device).shaders;
}

}  // namespace ibr
