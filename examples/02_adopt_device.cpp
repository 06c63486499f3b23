// SPDX-License-Identifier: Apache-2.0
// The caller owns the device, like an engine or an OpenXR runtime. Its create-infos are merged with
// Device::requirements(). libibr borrows the handles; here, ibr::Offscreen submits to the caller's queue and waits. An
// engine calls Renderer::record with its own command buffer and image instead. The example checks that the image equals
// the image from a device that libibr creates.
//
//   02_adopt_device SCENE
#include <ibr/ibr.h>

#include <cstdio>
#include <stdexcept>

namespace {

void require(VkResult result, const char* what) {
  if (result != VK_SUCCESS) throw std::runtime_error(std::string(what) + " failed");
}

std::vector<const char*> pointers(const std::vector<std::string>& names) {
  std::vector<const char*> result;
  for (const std::string& name : names) result.push_back(name.c_str());
  return result;
}

// The caller's Vulkan objects. An engine would add its own requirements to the same structures.
struct Engine {
  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physicalDevice = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  std::uint32_t queueFamily = 0;

  Engine() {
    ibr::DeviceRequirements needs = ibr::Device::requirements();
    VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
    application.apiVersion = needs.apiVersion;
    const std::vector<const char*> instanceExtensions = pointers(needs.instanceExtensions);
    VkInstanceCreateInfo instanceInfo{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
    instanceInfo.pApplicationInfo = &application;
    instanceInfo.enabledExtensionCount = std::uint32_t(instanceExtensions.size());
    instanceInfo.ppEnabledExtensionNames = instanceExtensions.data();
    require(vkCreateInstance(&instanceInfo, nullptr, &instance), "vkCreateInstance");

    std::uint32_t count = 1;  // for this example, take the first device
    if (vkEnumeratePhysicalDevices(instance, &count, &physicalDevice) < 0 || count == 0)
      throw std::runtime_error("no Vulkan device");
    std::uint32_t familyCount = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(physicalDevice, &familyCount, nullptr);
    std::vector<VkQueueFamilyProperties> families(familyCount);
    vkGetPhysicalDeviceQueueFamilyProperties(physicalDevice, &familyCount, families.data());
    while (queueFamily < familyCount && (families[queueFamily].queueFlags & needs.queueFlags) != needs.queueFlags)
      ++queueFamily;
    if (queueFamily == familyCount) throw std::runtime_error("no queue for graphics and compute");

    const float priority = 1;
    VkDeviceQueueCreateInfo queueInfo{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
    queueInfo.queueFamilyIndex = queueFamily;
    queueInfo.queueCount = 1;
    queueInfo.pQueuePriorities = &priority;
    const std::vector<const char*> deviceExtensions = pointers(needs.deviceExtensions);
    VkDeviceCreateInfo deviceInfo{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
    deviceInfo.pNext = needs.features.link();
    deviceInfo.queueCreateInfoCount = 1;
    deviceInfo.pQueueCreateInfos = &queueInfo;
    deviceInfo.enabledExtensionCount = std::uint32_t(deviceExtensions.size());
    deviceInfo.ppEnabledExtensionNames = deviceExtensions.data();
    require(vkCreateDevice(physicalDevice, &deviceInfo, nullptr, &device), "vkCreateDevice");
    vkGetDeviceQueue(device, queueFamily, 0, &queue);
  }
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;
  ~Engine() {
    if (device) vkDestroyDevice(device, nullptr);
    if (instance) vkDestroyInstance(instance, nullptr);
  }
};

ibr::Image8 render(ibr::Device& device, const ibr::Scene& scene) {
  const ibr::GpuScene gpuScene(device, scene);
  const ibr::Renderer renderer(device, gpuScene, {{640, 480}});
  ibr::Offscreen offscreen(device, {640, 480});
  ibr::Camera view = scene.nodes.at(scene.cells.at(0).members[0]).camera;
  view.intrinsics = ibr::pinholeFromFov(640, 480, 1.0);
  const ibr::FramePlan plan = ibr::planFrame(scene, ibr::sceneBounds(scene), {{view}, {}});
  return offscreen.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, offscreen.target()); });
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fputs("usage: 02_adopt_device SCENE\n", stderr);
    return 1;
  }
  const ibr::Scene scene = ibr::loadScene(argv[1]);
  const Engine engine;
  ibr::Device borrowed = ibr::Device::adopt({.instance = engine.instance,
                                             .physicalDevice = engine.physicalDevice,
                                             .device = engine.device,
                                             .queue = engine.queue,
                                             .queueFamily = engine.queueFamily});
  ibr::Device owned = ibr::Device::create({.device = borrowed.properties().deviceName});
  const bool same = render(borrowed, scene) == render(owned, scene);
  std::printf("%s: pictures of the borrowed and the owned device %s\n", borrowed.name().c_str(),
              same ? "are equal" : "DIFFER");
  return same ? 0 : 3;
} catch (const std::exception& error) {
  std::fprintf(stderr, "02_adopt_device: %s\n", error.what());
  return 2;
}
