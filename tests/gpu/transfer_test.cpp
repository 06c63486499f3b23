// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstddef>
#include <span>
#include <vector>

#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"
#include "command_buffers.h"
#include "gpu/transfer/readback.h"
#include "gpu/transfer/upload.h"
#include "support/gpu.h"

using namespace ibr;
using test::testDevice;

namespace {

using Bytes = std::vector<std::byte>;

constexpr VkBufferUsageFlags kCopied = VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
constexpr VkImageUsageFlags kTexture =
    VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;

/// Bytes that differ from their neighbours everywhere, and between seeds.
Bytes pattern(std::size_t count, unsigned seed) {
  Bytes bytes(count);
  unsigned state = 747796405u * seed + 2891336453u;
  for (std::byte& byte : bytes) byte = std::byte((state = 1664525u * state + 1013904223u) >> 24);
  return bytes;
}

Buffer deviceBuffer(VkDeviceSize size) {
  return Buffer(testDevice(), size, kCopied, MemoryKind::device, "tested");
}

GpuImage texture(VkFormat format, VkExtent2D extent, std::uint32_t layers = 1, std::uint32_t levels = 1) {
  return GpuImage(testDevice(),
                  {.format = format,
                   .extent = extent,
                   .layers = layers,
                   .mipLevels = levels,
                   .usage = kTexture,
                   .viewType = layers > 1 ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : VK_IMAGE_VIEW_TYPE_2D},
                  "tested");
}

Bytes read(const GpuImage& image, VkExtent2D extent, std::uint32_t bytesPerPixel, std::uint32_t layer = 0,
           std::uint32_t level = 0) {
  return readImage(testDevice(), image.get(), extent, bytesPerPixel, use::kSampled, VK_IMAGE_ASPECT_COLOR_BIT, layer,
                   level);
}

}  // namespace

TEST_CASE("host buffers are mapped and keep written bytes, device buffers are not mapped") {
  const auto size = GENERATE(VkDeviceSize(1), 3, 4096, 100001);
  const Buffer upload(testDevice(), size, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, MemoryKind::upload, "upload");
  const Buffer readback(testDevice(), size, VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryKind::readback, "readback");
  const Buffer device = deviceBuffer(size);
  CHECK(upload.mapped().size() == size);
  CHECK(readback.mapped().size() == size);
  CHECK(device.mapped().empty());
  CHECK(device.size() == size);
  CHECK(device.allocatedBytes() >= size);
  const Bytes bytes = pattern(size, 1);
  std::copy(bytes.begin(), bytes.end(), upload.mapped().begin());
  submitAndWait(testDevice(), [&](VkCommandBuffer commands) {
    const VkBufferCopy region{0, 0, size};
    vkCmdCopyBuffer(commands, upload.get(), device.get(), 1, &region);
    bufferBarrier(commands, use::kTransferWrite, use::kTransferRead);
    vkCmdCopyBuffer(commands, device.get(), readback.get(), 1, &region);
    bufferBarrier(commands, use::kTransferWrite, use::kHostRead);
  });
  CHECK(Bytes(readback.mapped().begin(), readback.mapped().end()) == bytes);
}

TEST_CASE("replacing a part of a buffer keeps the rest") {
  const Buffer buffer = deviceBuffer(1000);
  Bytes expected = pattern(1000, 1);
  uploadBuffer(testDevice(), buffer, 0, expected);
  const Bytes part = pattern(333, 2);
  uploadBuffer(testDevice(), buffer, 77, part);
  std::copy(part.begin(), part.end(), expected.begin() + 77);
  uploadBuffer(testDevice(), buffer, 1000, {});
  CHECK(readBuffer(testDevice(), buffer) == expected);
}

TEST_CASE("uploads larger than the staging buffer arrive completely") {
  const Bytes bytes = pattern((std::size_t(5) << 20) + 13, 3);
  const Buffer buffer = deviceBuffer(bytes.size());
  const VkExtent2D extent{701, 1001};  // 2.7 MiB: three pieces, none of a divisor's size
  const Bytes pixels = pattern(std::size_t(4) * extent.width * extent.height, 4);
  const GpuImage image = texture(VK_FORMAT_R8G8B8A8_UNORM, extent);
  Uploader uploader(testDevice(), 1);  // raised to the minimum
  uploader.buffer(buffer, 0, bytes);
  uploader.image(image, 0, 0, extent, pixels);
  uploader.flush();
  CHECK(readBuffer(testDevice(), buffer) == bytes);
  CHECK(read(image, extent, 4) == pixels);
}

TEST_CASE("images of odd sizes and formats are unchanged after upload and readback") {
  struct Case {
    VkFormat format;
    std::uint32_t bytesPerPixel;
  };
  const auto [format, bytesPerPixel] =
      GENERATE(Case{VK_FORMAT_R8_UNORM, 1}, Case{VK_FORMAT_R8G8B8A8_UNORM, 4}, Case{VK_FORMAT_R16G16B16A16_SFLOAT, 8},
               Case{VK_FORMAT_R32G32B32A32_SFLOAT, 16});
  const auto extent = GENERATE(VkExtent2D{1, 1}, VkExtent2D{3, 5}, VkExtent2D{257, 1}, VkExtent2D{1, 63});
  CAPTURE(format, extent.width, extent.height);
  const GpuImage image = texture(format, extent);
  const Bytes bytes = pattern(std::size_t(bytesPerPixel) * extent.width * extent.height, 5);
  Uploader uploader(testDevice());
  uploader.image(image, 0, 0, extent, bytes);
  uploader.flush();
  CHECK(read(image, extent, bytesPerPixel) == bytes);
  CHECK(read(image, {1, 1}, bytesPerPixel) == Bytes(bytes.begin(), bytes.begin() + bytesPerPixel));
}

TEST_CASE("every mip level of every layer is stored separately") {
  const VkExtent2D extent{13, 6};
  const std::uint32_t layers = 3, levels = 4;
  const GpuImage image = texture(VK_FORMAT_R8G8B8A8_UNORM, extent, layers, levels);
  const auto levelExtent = [&](std::uint32_t level) {
    return VkExtent2D{std::max(1u, extent.width >> level), std::max(1u, extent.height >> level)};
  };
  const auto levelBytes = [&](std::uint32_t layer, std::uint32_t level, unsigned seed) {
    return pattern(std::size_t(4) * levelExtent(level).width * levelExtent(level).height, seed + 10 * layer + level);
  };
  Uploader uploader(testDevice());
  for (std::uint32_t layer = 0; layer < layers; ++layer)
    for (std::uint32_t level = 0; level < levels; ++level)
      uploader.image(image, layer, level, levelExtent(level), levelBytes(layer, level, 0));
  uploader.flush();

  SECTION("as uploaded") {
    for (std::uint32_t layer = 0; layer < layers; ++layer)
      for (std::uint32_t level = 0; level < levels; ++level)
        CHECK(read(image, levelExtent(level), 4, layer, level) == levelBytes(layer, level, 0));
  }
  SECTION("a mip level replaced twice in a batch has the last content") {
    uploader.image(image, 1, 0, levelExtent(0), levelBytes(1, 0, 100));
    uploader.image(image, 1, 0, levelExtent(0), levelBytes(1, 0, 200));
    uploader.flush();
    CHECK(read(image, levelExtent(0), 4, 1, 0) == levelBytes(1, 0, 200));
    CHECK(read(image, levelExtent(0), 4, 0, 0) == levelBytes(0, 0, 0));
    CHECK(read(image, levelExtent(1), 4, 1, 1) == levelBytes(1, 1, 0));
  }
}

TEST_CASE("one layer can be uploaded without its other layers and mip levels") {
  const GpuImage image = texture(VK_FORMAT_R8_UNORM, {4, 4}, 8, 3);
  const Bytes bytes = pattern(16, 6);
  Uploader uploader(testDevice());
  uploader.image(image, 5, 0, {4, 4}, bytes);
  uploader.flush();
  CHECK(read(image, {4, 4}, 1, 5) == bytes);
}

TEST_CASE("overlapping uploads of one batch are written in order") {
  const Buffer buffer = deviceBuffer(64);
  Uploader uploader(testDevice());
  Bytes expected(64);
  for (unsigned i = 0; i < 4; ++i) {
    const Bytes piece = pattern(40, 20 + i);
    uploader.buffer(buffer, 8 * i, piece);
    std::copy(piece.begin(), piece.end(), expected.begin() + 8 * i);
  }
  uploader.flush();
  CHECK(readBuffer(testDevice(), buffer) == expected);
}

TEST_CASE("uploads wait for reads that were submitted earlier") {
  const Buffer buffer = deviceBuffer(4096), bufferCopy = deviceBuffer(4096), imageCopy = deviceBuffer(4096);
  const GpuImage image = texture(VK_FORMAT_R8_UNORM, {64, 64});
  const Bytes before = pattern(4096, 1), after = pattern(4096, 2);
  Uploader uploader(testDevice());
  uploader.buffer(buffer, 0, before);
  uploader.image(image, 0, 0, {64, 64}, before);
  uploader.flush();
  const test::CommandBuffers commands(testDevice(), 1);
  commands.submit(0, [&](VkCommandBuffer frame) {
    const VkBufferCopy region{0, 0, 4096};
    vkCmdCopyBuffer(frame, buffer.get(), bufferCopy.get(), 1, &region);
    transition(frame, image.get(), use::kSampled, use::kTransferSource);
    const VkBufferImageCopy imageRegion{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                        .imageExtent = {64, 64, 1}};
    vkCmdCopyImageToBuffer(frame, image.get(), use::kTransferSource.layout, imageCopy.get(), 1, &imageRegion);
  });
  uploader.buffer(buffer, 0, after);
  uploader.image(image, 0, 0, {64, 64}, after);
  uploader.flush();
  CHECK(readBuffer(testDevice(), bufferCopy) == before);
  CHECK(readBuffer(testDevice(), imageCopy) == before);
  CHECK(readBuffer(testDevice(), buffer) == after);
  CHECK(read(image, {64, 64}, 1) == after);
}

TEST_CASE("an empty upload is allowed") {
  Uploader uploader(testDevice());
  uploader.flush();
  uploader.buffer(deviceBuffer(4), 4, {});
  uploader.flush();
}

TEST_CASE("buffers and images can be moved") {
  const Bytes bytes = pattern(64, 7);
  Buffer a = deviceBuffer(64);
  uploadBuffer(testDevice(), a, 0, bytes);
  const VkBuffer handle = a.get();
  Buffer b = std::move(a);
  CHECK(a.get() == VK_NULL_HANDLE);
  Buffer c = deviceBuffer(32);
  c = std::move(b);  // destroys the previous buffer of c; otherwise the validation layer reports a leak
  CHECK(c.get() == handle);
  CHECK(c.size() == 64);
  CHECK(readBuffer(testDevice(), c) == bytes);
  Buffer& same = c;
  c = std::move(same);
  CHECK(readBuffer(testDevice(), c) == bytes);
  a = deviceBuffer(16);
  CHECK(a.size() == 16);

  GpuImage image = texture(VK_FORMAT_R8_UNORM, {8, 8});
  const VkImage imageHandle = image.get();
  GpuImage other = texture(VK_FORMAT_R8_UNORM, {2, 2});
  other = std::move(image);
  CHECK(other.get() == imageHandle);
  CHECK(other.view() != VK_NULL_HANDLE);
  CHECK(image.get() == VK_NULL_HANDLE);
}
