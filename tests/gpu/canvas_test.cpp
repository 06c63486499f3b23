// SPDX-License-Identifier: Apache-2.0
#include "gpu/draw/canvas.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstring>
#include <numeric>

#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/pipeline.h"
#include "base/vulkan/submit.h"
#include "command_buffers.h"
#include "gpu/draw/descriptors.h"
#include "gpu/transfer/readback.h"
#include "ibr/error.h"
#include "ibr/offscreen.h"
#include "shaders/test_scale_comp.h"
#include "support/gpu.h"
#include "support/upload_buffer.h"
#include "test_picture.h"

using namespace ibr;
using test::PicturePasses;
using test::square;
using test::testDevice;

namespace {

std::vector<std::byte> readColour(const Canvas& canvas, VkExtent2D extent) {
  return readImage(testDevice(), canvas.colour(), extent, 4, use::kSampled);
}

std::vector<float> readDepth(const Canvas& canvas, VkExtent2D extent) {
  const auto bytes = readImage(testDevice(), canvas.depth(), extent, 4, use::kSampled, VK_IMAGE_ASPECT_DEPTH_BIT);
  std::vector<float> depth(bytes.size() / sizeof(float));
  std::memcpy(depth.data(), bytes.data(), bytes.size());
  return depth;
}

std::array<int, 4> pixel(const std::vector<std::byte>& bytes, std::size_t index) {
  return {int(bytes[4 * index]), int(bytes[4 * index + 1]), int(bytes[4 * index + 2]), int(bytes[4 * index + 3])};
}

using Pixel = std::array<int, 4>;

}  // namespace

TEST_CASE("a canvas without draws keeps the clear values") {
  const Canvas canvas(testDevice(), {33, 17});
  const auto extent = GENERATE(VkExtent2D{33, 17}, VkExtent2D{1, 1}, VkExtent2D{32, 5});
  submitAndWait(testDevice(), [&](VkCommandBuffer commands) {
    canvas.begin(commands, extent, {1.0f, 0.0f, 0.2f, 0.4f});
    canvas.end(commands);
  });
  const auto colour = readColour(canvas, extent);
  for (std::size_t i = 0; i < colour.size() / 4; ++i) REQUIRE(pixel(colour, i) == Pixel{255, 0, 51, 102});
  const auto depth = readDepth(canvas, extent);
  CHECK(std::all_of(depth.begin(), depth.end(), [](float d) { return d == 1.0f; }));
  CHECK(canvas.allocatedBytes() >= 2 * 4 * 33 * 17);
}

TEST_CASE("depth decides between triangles in any draw order") {
  const bool nearFirst = GENERATE(true, false);
  auto near = square(-1, 0, 0.25f, {1, 0, 0}), far = square(-1, 1, 0.75f, {0, 0, 1});
  auto vertices = nearFirst ? near : far;
  for (const auto& vertex : nearFirst ? far : near) vertices.push_back(vertex);
  const PicturePasses passes(testDevice(), {2, 1}, vertices, {});
  submitAndWait(testDevice(), [&](VkCommandBuffer commands) { passes.recordCanvas(commands, {2, 1}); });
  const auto colour = readColour(passes.canvas(), {2, 1});
  CHECK(pixel(colour, 0) == Pixel{255, 0, 0, 255});
  CHECK(pixel(colour, 1) == Pixel{0, 0, 255, 255});
  CHECK(readDepth(passes.canvas(), {2, 1}) == std::vector<float>{0.25f, 0.75f});
}

TEST_CASE("without a depth test the last triangle wins and depth stays unchanged") {
  auto vertices = square(-1, 1, 0.25f, {1, 0, 0});
  for (const auto& vertex : square(-1, 1, 0.75f, {0, 0, 1})) vertices.push_back(vertex);
  const PicturePasses passes(testDevice(), {1, 1}, vertices, {.depth = false});
  submitAndWait(testDevice(), [&](VkCommandBuffer commands) { passes.recordCanvas(commands, {1, 1}); });
  CHECK(pixel(readColour(passes.canvas(), {1, 1}), 0) == Pixel{0, 0, 255, 255});
  CHECK(readDepth(passes.canvas(), {1, 1})[0] == 1.0f);
}

TEST_CASE("depth clamp keeps triangles in front of the near plane", "[N6][T10]") {
  const PicturePasses passes(testDevice(), {1, 1}, square(-1, 1, -3.0f, {0, 1, 0}), {});
  submitAndWait(testDevice(), [&](VkCommandBuffer commands) { passes.recordCanvas(commands, {1, 1}); });
  CHECK(pixel(readColour(passes.canvas(), {1, 1}), 0) == Pixel{0, 255, 0, 255});
  CHECK(readDepth(passes.canvas(), {1, 1})[0] == 0.0f);
}

TEST_CASE("specialisation constants reach the shader") {
  const PicturePasses passes(testDevice(), {1, 1}, square(-1, 1, 0.5f, {1, 1, 0}), {.brightness = 0.2f});
  submitAndWait(testDevice(), [&](VkCommandBuffer commands) { passes.recordCanvas(commands, {1, 1}); });
  CHECK(pixel(readColour(passes.canvas(), {1, 1}), 0) == Pixel{51, 51, 0, 255});
}

TEST_CASE("a composed image is exact in every target format") {
  const auto format = GENERATE(VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_B8G8R8A8_UNORM);
  const VkExtent2D extent{16, 8};
  auto vertices = square(-1.0f, 0.0f, 0.25f, {1, 0, 0});
  for (const auto& vertex : square(-0.5f, 0.5f, 0.5f, {0, 1, 0})) vertices.push_back(vertex);
  const PicturePasses passes(testDevice(), {20, 30}, vertices, {.target = format});
  Offscreen offscreen(testDevice(), extent, format);
  for (int i = 0; i < 2; ++i)
    CHECK(offscreen.render([&](VkCommandBuffer commands) {
      passes.recordCanvas(commands, extent);
      passes.recordComposition(commands, offscreen.target());
    }) == test::expectedPicture());
}

TEST_CASE("one canvas serves frames in flight without further barriers") {
  const VkExtent2D extent{16, 8};
  const PicturePasses red(testDevice(), extent, square(-1, 1, 0.5f, {1, 0, 0}), {});
  std::vector<Offscreen> targets;
  for (int i = 0; i < 3; ++i) targets.emplace_back(testDevice(), extent);
  const test::CommandBuffers commands(testDevice(), 3);
  for (std::size_t i = 0; i < 3; ++i)
    commands.submit(i, [&](VkCommandBuffer frame) {
      red.recordCanvas(frame, extent);
      red.recordComposition(frame, targets[i].target());
      red.recordCanvas(frame, extent);  // twice in one command buffer
      red.recordComposition(frame, targets[i].target());
    });
  CHECK(vkQueueWaitIdle(testDevice().queue()) == VK_SUCCESS);
  const auto last = readImage(testDevice(), targets[2].target().image, extent, 4, targets[2].target().finalUse);
  CHECK(pixel(last, 0) == Pixel{255, 0, 0, 255});
}

TEST_CASE("a frame waits until transfers have read the previous frame") {
  const VkExtent2D extent{8, 8};
  const PicturePasses passes(testDevice(), extent, square(-1, 1, 0.5f, {1, 0, 0}), {});
  const Buffer colour(testDevice(), 256, VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryKind::readback, "colour");
  const test::CommandBuffers commands(testDevice(), 2);
  commands.submit(0, [&](VkCommandBuffer frame) {
    passes.recordCanvas(frame, extent);
    transition(frame, passes.canvas().colour(), use::kSampled, use::kTransferSource);
    const VkBufferImageCopy region{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1}, .imageExtent = {8, 8, 1}};
    vkCmdCopyImageToBuffer(frame, passes.canvas().colour(), use::kTransferSource.layout, colour.get(), 1, &region);
    bufferBarrier(frame, use::kTransferWrite, use::kHostRead);
  });
  commands.submit(1, [&](VkCommandBuffer frame) { passes.recordCanvas(frame, extent); });
  CHECK(vkQueueWaitIdle(testDevice().queue()) == VK_SUCCESS);
  CHECK(int(colour.mapped()[0]) == 255);
}

TEST_CASE("recorded commands that are never submitted have no effect") {
  const VkExtent2D extent{4, 4};
  const PicturePasses passes(testDevice(), extent, square(-1, 1, 0.5f, {1, 0, 0}), {});
  {
    const test::CommandBuffers commands(testDevice(), 1);
    commands.record(0, [&](VkCommandBuffer frame) { passes.recordCanvas(frame, extent); });
  }
  submitAndWait(testDevice(), [&](VkCommandBuffer commands) { passes.recordCanvas(commands, extent); });
  CHECK(pixel(readColour(passes.canvas(), extent), 0) == Pixel{255, 0, 0, 255});
}

TEST_CASE("a compute pass reads and writes a buffer") {
  const std::uint32_t count = 1000, factor = 3, summand = 7;
  std::vector<std::uint32_t> values(count);
  std::iota(values.begin(), values.end(), 0u);
  const Buffer buffer(
      testDevice(), values.size() * 4,
      VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
      MemoryKind::device, "values");
  test::uploadBuffer(testDevice(), buffer, 0, std::as_bytes(std::span(values)));

  const VkDescriptorSetLayoutBinding bindings[]{
      {0, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr}};
  const auto setLayout = makeSetLayout(testDevice(), bindings);
  const VkDescriptorPoolSize sizes[]{{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1}};
  const auto pool = makeDescriptorPool(testDevice(), 1, sizes);
  const VkDescriptorSet set = allocateSet(testDevice(), pool.get(), setLayout.get());
  writeStorageBuffer(testDevice(), set, 0, buffer.get());
  const VkDescriptorSetLayout layouts[]{setLayout.get()};
  const VkPushConstantRange ranges[]{{VK_SHADER_STAGE_COMPUTE_BIT, 0, 8}};
  const auto layout = makePipelineLayout(testDevice(), layouts, ranges);
  const VkSpecializationMapEntry entries[]{{0, 0, 4}};
  const auto pipeline =
      makeComputePipeline(testDevice(), {.name = "scale",
                                         .shader = shaders::test_scale_comp,
                                         .specialisation = {entries, std::as_bytes(std::span(&factor, 1))},
                                         .layout = layout.get()});
  submitAndWait(testDevice(), [&](VkCommandBuffer commands) {
    const std::uint32_t push[]{count - 1, summand};  // the last value stays unchanged
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.get());
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout.get(), 0, 1, &set, 0, nullptr);
    vkCmdPushConstants(commands, layout.get(), VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(push), push);
    for (int i = 0; i < 2; ++i) {
      vkCmdDispatch(commands, (count + 63) / 64, 1, 1);
      bufferBarrier(commands, use::kComputeReadWrite, use::kComputeReadWrite);
    }
  });
  for (std::uint32_t i = 0; i + 1 < count; ++i) values[i] = factor * (factor * values[i] + summand) + summand;
  const auto bytes = std::as_bytes(std::span(values));
  CHECK(readBuffer(testDevice(), buffer) == std::vector<std::byte>(bytes.begin(), bytes.end()));
}
