// SPDX-License-Identifier: Apache-2.0
// Device memory from the caller's allocator (ibr/device_memory.h).
#include "ibr/device_memory.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <functional>
#include <string>
#include <vector>

#include "base/vulkan/barrier.h"
#include "base/vulkan/buffer.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/gpu_image.h"
#include "base/vulkan/memory.h"
#include "base/vulkan/submit.h"
#include "engine/adopted_test_device.h"
#include "faults/small_place.h"
#include "support/error_of.h"
#include "support/hand_executor.h"
#include "support/sub_allocator.h"
#include "support/vulkan_calls.h"

using namespace ibr;
using namespace ibr::test;
using Catch::Contains;

namespace {

Device adopted(DeviceAllocator& allocator) {
  DeviceHandles handles = testDeviceHandles();
  handles.allocator = &allocator;
  return Device::adopt(handles);
}

std::vector<RenderSettings> looks() {
  std::vector<RenderSettings> all(3);
  all[0].colourMapping = ColourMapping::ours;
  all[1].composition = Composition::gathered;
  all[1].maxTier = kTierFilled;
  all[2].overlay = Overlay::confidence;
  return all;
}

std::vector<Image8> images(const SmallScene& place, Device& device) {
  const GpuScene scene = place.open(device);
  std::vector<Image8> all;
  for (const RenderSettings& settings : looks())
    for (Image8& image : place.pictures(device, scene, place.plan(settings))) all.push_back(std::move(image));
  return all;
}

/// Images of the first frames under a budget that is too small for all photographs.
std::vector<Image8> streamedImages(const SmallScene& place, Device& device, std::uint64_t budget) {
  GpuScene scene = place.open(device, {.budgetBytes = budget, .stagingBytes = 1 << 20, .readerThreads = 0});
  REQUIRE(scene.needsStreaming());
  const Renderer renderer(device, scene, optionsFor({}, {48, 36}));
  Offscreen offscreen(device, {48, 36});
  const FramePlan plan = place.plan({});
  std::vector<Image8> all;
  for (std::uint64_t frame = 1; frame < 8; ++frame) {
    all.push_back(offscreen.render([&](VkCommandBuffer commands) {
      scene.stream(commands, plan, frame, frame - 1);
      renderer.record(commands, plan, offscreen.target());
    }));
    CHECK(scene.memory().sum() <= budget);
  }
  return all;
}

std::vector<float> bufferValues(const SmallScene& place, Device& device) {
  const GpuScene scene = place.open(device);
  const FramePlan plan = place.plan({});
  RendererOptions options = optionsFor(plan.settings, {48, 36});
  options.bufferScene = &place.scene();
  const Renderer renderer(device, scene, options);
  OffscreenBuffers offscreen(device, {48, 36});
  const FrameBuffers buffers = offscreen.render(
      [&](VkCommandBuffer commands) { renderer.recordBuffers(commands, plan, 0, offscreen.targets()); });
  std::vector<float> values;
  for (const ImageF* image : {&buffers.surface, &buffers.weights, &buffers.confidence})
    values.insert(values.end(), image->values.begin(), image->values.end());
  return values;
}

/// Changes every block of a sub-allocator.
class Changed : public SubAllocator {
 public:
  explicit Changed(std::function<void(MemoryBlock&)> change) : change_(std::move(change)) {}
  MemoryBlock allocate(const MemoryRequest& request) override {
    MemoryBlock block = SubAllocator::allocate(request);
    change_(block);
    return block;
  }

 private:
  std::function<void(MemoryBlock&)> change_;
};

/// Keeps copies of the requests.
class Observed : public SubAllocator {
 public:
  struct Seen {
    std::string name;
    VkMemoryRequirements requirements;
    MemoryKind kind;
    ResourceTiling tiling;
    VkMemoryPropertyFlags required;
  };
  MemoryBlock allocate(const MemoryRequest& request) override {
    seen.push_back({std::string(request.name), request.requirements, request.kind, request.tiling, request.required});
    return SubAllocator::allocate(request);
  }
  std::vector<Seen> seen;
};

constexpr VkBufferUsageFlags kCopied = VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;

}  // namespace

TEST_CASE("a sub-allocator holds all memory of scenes and renderers, and the images are the same") {
  const SmallScene place;
  Device plain = Device::adopt(testDeviceHandles());
  const VulkanCalls before = vulkanCalls();
  const std::vector<Image8> expected = images(place, plain);
  const GpuScene::Memory expectedMemory = place.open(plain).memory();
  const VulkanCalls without = vulkanCalls() - before;
  CHECK(without.allocations == without.frees);

  SubAllocator allocator;
  {
    Device device = adopted(allocator);
    const VulkanCalls start = vulkanCalls();
    CHECK((images(place, device) == expected));
    const GpuScene scene = place.open(device);
    const VulkanCalls with = vulkanCalls() - start;
    CHECK(scene.memory().sum() == expectedMemory.sum());
    CHECK(scene.memory().textures == expectedMemory.textures);
    CHECK(allocator.requests() == without.allocations);
    CHECK(allocator.vulkanAllocations() == with.allocations);  // libibr itself allocates nothing
    CHECK(3 * with.allocations < without.allocations);
    CHECK(allocator.blockCount() > 2 * allocator.memoryCount());
    CHECK(allocator.memoryCount() <= 4);
  }
  CHECK(allocator.blockCount() == 0);
  CHECK(allocator.memoryCount() == 0);
  const VulkanCalls all = vulkanCalls() - before;
  CHECK(all.allocations == all.frees);
}

TEST_CASE("streamed photographs and buffers are the same with a sub-allocator") {
  const SmallScene place;
  Device plain = Device::adopt(testDeviceHandles());
  SubAllocator allocator;
  Device device = adopted(allocator);
  const std::uint64_t budget = place.open(plain).memory().sum() - 1;
  const VulkanCalls before = vulkanCalls();
  CHECK((streamedImages(place, device, budget) == streamedImages(place, plain, budget)));
  CHECK((bufferValues(place, device) == bufferValues(place, plain)));
  CHECK(allocator.requests() > allocator.vulkanAllocations());
  CHECK(allocator.blockCount() == 0);
  const VulkanCalls calls = vulkanCalls() - before;
  CHECK(calls.allocations == calls.frees);
}

TEST_CASE("a created device takes its memory from the allocator") {
  const SmallScene place;
  const std::vector<Image8> expected = place.pictures(testDevice(), place.open(testDevice()), place.plan({}));
  SubAllocator allocator(VkDeviceSize(1) << 20);  // most memory holds a single block
  {
    Device device = Device::create({.validation = true, .log = testLog(), .allocator = &allocator});
    CHECK(device.allocator() == &allocator);
    CHECK((place.pictures(device, place.open(device), place.plan({})) == expected));
    CHECK(allocator.requests() > 10);
  }
  CHECK(allocator.memoryCount() == 0);
  CHECK(testDevice().allocator() == nullptr);
}

TEST_CASE("mapping and binding begin at a block's offset") {
  SubAllocator allocator;
  const Device device = adopted(allocator);
  constexpr VkDeviceSize kSize = 300;
  std::vector<Buffer> sources, results;
  const Buffer between(device, 4 * kSize, kCopied, MemoryKind::device, "between");
  for (int i = 0; i < 4; ++i) {
    sources.emplace_back(device, kSize, kCopied, MemoryKind::upload, "source");
    results.emplace_back(device, kSize, kCopied, MemoryKind::readback, "result");
    std::ranges::fill(sources.back().mapped(), std::byte(10 + i));
  }
  CHECK(between.mapped().empty());
  CHECK(allocator.memoryCount() <= 3);  // so the sources share memory
  submitAndWait(device, [&](VkCommandBuffer commands) {
    for (std::size_t i = 0; i < 4; ++i) {
      const VkBufferCopy region{0, i * kSize, kSize};
      vkCmdCopyBuffer(commands, sources[i].get(), between.get(), 1, &region);
    }
    bufferBarrier(commands, use::kTransferWrite, use::kTransferRead);
    for (std::size_t i = 0; i < 4; ++i) {
      const VkBufferCopy region{i * kSize, 0, kSize};
      vkCmdCopyBuffer(commands, between.get(), results[i].get(), 1, &region);
    }
    bufferBarrier(commands, use::kTransferWrite, use::kHostRead);
  });
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(results[i].mapped().size() == kSize);
    CHECK(std::ranges::all_of(results[i].mapped(), [&](std::byte value) { return value == std::byte(10 + i); }));
  }
}

TEST_CASE("a moved buffer gives its block back once") {
  SubAllocator allocator;
  const Device device = adopted(allocator);
  Buffer a(device, 64, kCopied, MemoryKind::upload, "a");
  Buffer b = std::move(a);
  CHECK(allocator.blockCount() == 1);
  a = Buffer(device, 32, kCopied, MemoryKind::upload, "another");
  CHECK(allocator.blockCount() == 2);
  b = std::move(a);
  CHECK(allocator.blockCount() == 1);
  Buffer& same = b;
  b = std::move(same);
  CHECK(allocator.blockCount() == 1);
  CHECK(b.mapped().size() == 32);
  b = Buffer();
  CHECK(allocator.blockCount() == 0);
}

TEST_CASE("a request describes the resource and the memory types to choose from") {
  Observed allocator;
  const Device device = adopted(allocator);
  const Buffer kept(device, 100, kCopied, MemoryKind::device, "kept");
  const Buffer written(device, 200, kCopied, MemoryKind::upload, "written");
  const Buffer read(device, 300, kCopied, MemoryKind::readback, "read");
  const GpuImage image(
      device, {.format = VK_FORMAT_R8G8B8A8_UNORM, .extent = {8, 8}, .usage = VK_IMAGE_USAGE_SAMPLED_BIT}, "shown");
  REQUIRE(allocator.seen.size() == 4);
  const char* const names[]{"kept", "written", "read", "shown"};
  const MemoryKind kinds[]{MemoryKind::device, MemoryKind::upload, MemoryKind::readback, MemoryKind::device};
  const VkDeviceSize sizes[]{kept.allocatedBytes(), written.allocatedBytes(), read.allocatedBytes(),
                             image.allocatedBytes()};
  constexpr VkMemoryPropertyFlags kMapped = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  for (std::size_t i = 0; i < 4; ++i) {
    const Observed::Seen& seen = allocator.seen[i];
    CHECK(seen.name == names[i]);
    CHECK(seen.kind == kinds[i]);
    CHECK(seen.tiling == (i < 3 ? ResourceTiling::linear : ResourceTiling::optimal));
    CHECK(seen.requirements.size == sizes[i]);
    CHECK(seen.requirements.alignment > 0);
    CHECK(seen.required == (kinds[i] == MemoryKind::device ? 0 : kMapped));
    CHECK(seen.requirements.memoryTypeBits != 0);
    for (std::uint32_t type = 0; type < VK_MAX_MEMORY_TYPES; ++type)
      if (seen.requirements.memoryTypeBits >> type & 1)
        CHECK((device.memoryProperties().memoryTypes[type].propertyFlags & seen.required) == seen.required);
  }
}

TEST_CASE("an allocator without memory is reported with the resource, its size and the code outOfMemory") {
  SubAllocator allocator;
  const Device device = adopted(allocator);
  allocator.isFull = true;
  const Error error = errorOf([&] { Buffer(device, 4096, kCopied, MemoryKind::upload, "sought"); });
  CHECK(error.code() == ErrorCode::outOfMemory);
  CHECK_THAT(error.what(), Contains("sought") && Contains("allocator") && Contains("4096"));
  CHECK(errorOf([&] {
          GpuImage(device, {.format = VK_FORMAT_R8_UNORM, .extent = {8, 8}, .usage = VK_IMAGE_USAGE_SAMPLED_BIT},
                   "sought");
        }).code() == ErrorCode::outOfMemory);
  allocator.isFull = false;
  CHECK(Buffer(device, 4096, kCopied, MemoryKind::upload, "sought").mapped().size() == 4096);
  CHECK(allocator.blockCount() == 0);
}

TEST_CASE("requests beyond the memory heaps do not reach the allocator") {
  SubAllocator allocator;
  const Device device = adopted(allocator);
  const VkMemoryRequirements huge{.size = VkDeviceSize(1) << 50, .alignment = 1, .memoryTypeBits = ~0u};
  const Error error = errorOf([&] { Allocation(device, huge, MemoryKind::device, ResourceTiling::linear, "monster"); });
  CHECK(error.code() == ErrorCode::outOfMemory);
  CHECK_THAT(error.what(), Contains("monster") && Contains("heap"));
  CHECK(allocator.requests() == 0);
}

TEST_CASE("an Error of the allocator reaches the caller") {
  class Refusing : public DeviceAllocator {
   public:
    MemoryBlock allocate(const MemoryRequest&) override { throw Error(ErrorCode::unsupported, "not for libibr"); }
    void free(const MemoryBlock&) noexcept override {}
  };
  Refusing allocator;
  Device device = adopted(allocator);
  const SmallScene place;
  const Error error = errorOf([&] { place.open(device); });
  CHECK(error.code() == ErrorCode::unsupported);
  CHECK_THAT(error.what(), Contains("not for libibr"));
}

TEST_CASE("faulty blocks are refused with the resource's name and given back") {
  struct Fault {
    const char* message;
    MemoryKind kind;
    std::function<void(MemoryBlock&)> change;
  };
  const Fault fault =
      GENERATE(Fault{"offset", MemoryKind::device, [](MemoryBlock& block) { block.offset += 1; }},
               Fault{"bytes", MemoryKind::readback, [](MemoryBlock& block) { block.size -= 1; }},
               Fault{"bytes", MemoryKind::device, [](MemoryBlock& block) { block.size = 0; }},
               Fault{"not mapped", MemoryKind::upload, [](MemoryBlock& block) { block.mapped = nullptr; }},
               Fault{"not mapped", MemoryKind::readback, [](MemoryBlock& block) { block.mapped = nullptr; }});
  CAPTURE(fault.message);
  Changed allocator(fault.change);
  const Device device = adopted(allocator);
  const Error error = errorOf([&] { Buffer(device, 4096, kCopied, fault.kind, "refused"); });
  CHECK(error.code() == ErrorCode::invalidInput);
  CHECK_THAT(error.what(), Contains("refused") && Contains("allocator") && Contains(fault.message));
  CHECK(allocator.requests() == 1);
  CHECK(allocator.blockCount() == 0);
}

TEST_CASE("a missing mapping is no fault of a block for the device alone") {
  Changed allocator([](MemoryBlock& block) { block.mapped = nullptr; });
  const Device device = adopted(allocator);
  CHECK(Buffer(device, 64, kCopied, MemoryKind::device, "unmapped").mapped().empty());
}

TEST_CASE("streaming lowers its budget where the allocator is full") {
  const SmallScene place;
  SubAllocator allocator;
  Device device = adopted(allocator);
  const std::uint64_t all = place.open(device).memory().sum();
  std::string warnings;
  const bool inJobs = GENERATE(false, true);  // texture arrays are made on another thread
  HandExecutor hand;
  GpuScene scene = place.open(device, {.budgetBytes = all - 1,
                                       .log =
                                           [&](LogLevel level, std::string_view text) {
                                             if (level == LogLevel::warning) warnings += text;
                                           },
                                       .readerThreads = inJobs ? 2u : 0u,
                                       .executor = hand.executor()});
  const Renderer renderer(device, scene, optionsFor({}, {48, 36}));
  Offscreen offscreen(device, {48, 36});
  const FramePlan plan = place.plan({});
  REQUIRE(scene.needsStreaming());
  const std::uint64_t standIns = scene.memory().sum();
  allocator.isFull = true;
  for (std::uint64_t frame = 1; frame < 4; ++frame) {
    offscreen.render([&](VkCommandBuffer commands) {
      scene.stream(commands, plan, frame, frame - 1);
      renderer.record(commands, plan, offscreen.target());
    });
    hand.runAll();
  }
  CHECK(scene.memory().sum() == standIns);
  CHECK_THAT(warnings, Contains("the budget is lowered") && Contains("the allocator has no memory"));
}
