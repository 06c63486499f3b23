// SPDX-License-Identifier: Apache-2.0
// GpuScene::stream allocates nothing on the thread of the frame: neither host memory nor objects of the device. The
// program replaces operator new (support/allocation_count.cpp), and the Vulkan functions that allocate.
#include <atomic>
#include <catch2/catch.hpp>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "base/vulkan/submit.h"
#include "faults/small_place.h"
#include "lab/generate/photograph_field.h"
#include "reference/grid_walk.h"
#include "render/resident/gpu_scene_state.h"
#include "support/allocation_count.h"
#include "support/gpu.h"
#include "support/vulkan_replacement.h"

using namespace ibr;
using namespace ibr::test;

namespace {

thread_local bool counts = false;       // between begin and end of a Count, outside of Vulkan
thread_local std::size_t inVulkan = 0;  // heap allocations of drivers and layers while they record
thread_local int deviceAllocations = 0;
std::atomic<int> allDeviceAllocations = 0;

/// Counts allocations of this thread, without those of Vulkan.
class Count {
 public:
  Count() { counts = true; }
  ~Count() { counts = false; }
  std::size_t host() const { return allocationCount() - inVulkan - hostBefore_; }
  int device() const { return deviceAllocations - deviceBefore_; }

 private:
  std::size_t hostBefore_ = allocationCount() - inVulkan;
  int deviceBefore_ = deviceAllocations;
};

/// A call of Vulkan.
struct Pause {
  bool counted = std::exchange(counts, false);
  std::size_t before = allocationCount();
  ~Pause() {
    inVulkan += allocationCount() - before;
    counts = counted;
  }
};

#define IBR_ALLOCATES(name, Result, parameters, arguments) \
  IBR_REPLACE(Result, name, parameters) {                  \
    deviceAllocations += counts;                           \
    ++allDeviceAllocations;                                \
    const Pause pause;                                     \
    return real_##name arguments;                          \
  }
#define IBR_RECORDS(name, parameters, arguments) \
  IBR_REPLACE(void, name, parameters) {          \
    const Pause pause;                           \
    real_##name arguments;                       \
  }

IBR_ALLOCATES(vkAllocateMemory, VkResult,
              (VkDevice device, const VkMemoryAllocateInfo* info, const VkAllocationCallbacks* allocation,
               VkDeviceMemory* memory),
              (device, info, allocation, memory))
IBR_ALLOCATES(vkFreeMemory, void, (VkDevice device, VkDeviceMemory memory, const VkAllocationCallbacks* allocation),
              (device, memory, allocation))
IBR_ALLOCATES(vkCreateImage, VkResult,
              (VkDevice device, const VkImageCreateInfo* info, const VkAllocationCallbacks* allocation, VkImage* image),
              (device, info, allocation, image))
IBR_ALLOCATES(vkDestroyImage, void, (VkDevice device, VkImage image, const VkAllocationCallbacks* allocation),
              (device, image, allocation))
IBR_ALLOCATES(vkCreateBuffer, VkResult,
              (VkDevice device, const VkBufferCreateInfo* info, const VkAllocationCallbacks* allocation,
               VkBuffer* buffer),
              (device, info, allocation, buffer))
IBR_ALLOCATES(vkCreateDescriptorPool, VkResult,
              (VkDevice device, const VkDescriptorPoolCreateInfo* info, const VkAllocationCallbacks* allocation,
               VkDescriptorPool* pool),
              (device, info, allocation, pool))
IBR_ALLOCATES(vkAllocateDescriptorSets, VkResult,
              (VkDevice device, const VkDescriptorSetAllocateInfo* info, VkDescriptorSet* sets), (device, info, sets))
IBR_RECORDS(vkCmdPipelineBarrier2, (VkCommandBuffer commands, const VkDependencyInfo* info), (commands, info))
IBR_RECORDS(vkCmdCopyBufferToImage,
            (VkCommandBuffer commands, VkBuffer from, VkImage to, VkImageLayout layout, std::uint32_t count,
             const VkBufferImageCopy* regions),
            (commands, from, to, layout, count, regions))
IBR_RECORDS(vkCmdCopyBuffer,
            (VkCommandBuffer commands, VkBuffer from, VkBuffer to, std::uint32_t count, const VkBufferCopy* regions),
            (commands, from, to, count, regions))
IBR_RECORDS(vkUpdateDescriptorSets,
            (VkDevice device, std::uint32_t writeCount, const VkWriteDescriptorSet* writes, std::uint32_t copyCount,
             const VkCopyDescriptorSet* copies),
            (device, writeCount, writes, copyCount, copies))

// Must follow all replacements.
const bool installed = installVulkanReplacements();

/// Grid of photographs of two sizes.
Scene twoSizes(int side) {
  Scene scene = gridScene(side, 256, 256);
  for (std::size_t n = 1; n < scene.nodes.size(); n += 2) {
    Intrinsics& k = scene.nodes[n].camera.intrinsics;
    k = resized(k, 128, 128);
  }
  for (Cell& cell : scene.cells)
    for (std::size_t i = 0; i < cell.members.size(); ++i)
      if (cell.members[i] % 2 == 1)
        for (glm::vec2& match : cell.mesh.match[i]) match *= 0.5f;
  return scene;
}

}  // namespace

TEST_CASE("frames that stream allocate neither host nor device memory") {
  REQUIRE(installed);
  constexpr int kSide = 12;
  const bool streamsMeshes = GENERATE(false, true);
  const Scene scene = streamsMeshes ? photographField(kSide, 256, {}) : twoSizes(kSide);
  const std::uint64_t budget = streamsMeshes ? 20 * kMiB : 8 * kMiB;
  const SceneBounds bounds = sceneBounds(scene);
  const std::thread::id framesThread = std::this_thread::get_id();
  std::atomic<bool> readsHere = false;  // on the thread of the frame, after the constructor
  std::atomic<bool> opened = false;
  const TextureSource source = [&](const Scene& of, std::size_t node, int firstLevel) {
    if (opened && std::this_thread::get_id() == framesThread) readsHere = true;
    return Colours{}(of, node, firstLevel);
  };
  GpuScene gpuScene(testDevice(), scene, {.source = source, .budgetBytes = budget, .stagingBytes = 1 * kMiB});
  opened = true;
  REQUIRE(gpuScene.needsStreaming());
  REQUIRE(stateOf(gpuScene).meshes.streams() == streamsMeshes);
  std::uint64_t number = 0, uploaded = 0;
  std::size_t host = 0;  // allocations in stream()
  int onDevice = 0;
  GpuScene::StreamStatus status;
  const auto frame = [&](double along) {
    const FramePlan plan =
        planFrame(scene, bounds, {{cameraAt({along, 0, along}, 0, 0, 64, 64, 1.2)}, {.switchSeconds = 0}});
    ++number;
    submitAndWait(testDevice(), [&](VkCommandBuffer commands) {
      const Count count;
      status = gpuScene.stream(commands, plan, number, number - 1);
      host += count.host();
      onDevice += count.device();
    });
    uploaded += status.uploadedBytes;
  };
  const auto walk = [&] {
    for (int f = 0; f < 200; ++f) frame(f * (kSide - 1) / 199.0);
    do frame(kSide - 1);
    while (status.waiting > 0);
    do frame(0);
    while (status.waiting > 0);
  };
  const int before = allDeviceAllocations;
  walk();
  CHECK(uploaded > 0);
  CHECK(allDeviceAllocations > before);  // on other threads
  CHECK(host == 0);
  CHECK(onDevice == 0);
  CHECK_FALSE(readsHere);

  {  // the counters count
    std::vector<char> made;
    const Count count;
    made.push_back(0);
    host = count.host();
    CHECK(host == 1);
  }
  {
    GpuScene synchronous(testDevice(), scene, {.source = Colours{}, .budgetBytes = budget, .readerThreads = 0});
    gpuScene = std::move(synchronous);
    number = 0;
    frame(0);
    CHECK(onDevice > 0);
    CHECK(host > 1);
  }
}

TEST_CASE("recorded frames allocate neither host nor device memory") {
  const SmallScene place;
  Device device = Device::create();  // without validation, whose layer allocates
  GpuScene scene = place.open(device);
  std::vector<RenderSettings> looks(5);
  looks[0].maxTier = kTierFilled;
  looks[1].colourMapping = ColourMapping::ours;
  looks[2].overlay = Overlay::confidence;
  looks[2].floor = Floor{.height = -1};
  looks[3].composition = Composition::hybrid;
  looks[4].morph = Morph::paper;
  for (const RenderSettings& settings : looks)
    for (const std::uint32_t views : {1u, 2u}) {
      CAPTURE(&settings - looks.data(), views);
      const FramePlan plan = place.plan(settings, views);
      RendererOptions options = optionsFor(settings, {48, 36});
      options.maxViews = views;
      options.uncertaintyScene = &place.scene();
      const Renderer renderer(device, scene, options);
      Offscreen offscreen(device, {48, 36}), second(device, {48, 36});
      ScopeTimer timer(device, 64);
      const std::vector<Target> targets{offscreen.target(), second.target()};
      std::size_t host = 1;  // allocations in record()
      int onDevice = 1;
      offscreen.render([&](VkCommandBuffer commands) {
        timer.reset(commands);
        const Count count;
        renderer.record(commands, plan, std::span(targets).first(views), &timer);
        host = count.host();
        onDevice = count.device();
      });
      CHECK(host == 0);
      CHECK(onDevice == 0);
    }
}
