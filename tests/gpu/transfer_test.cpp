// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"
#include "command_buffers.h"
#include "gpu/transfer/readback.h"
#include "gpu/transfer/staging_pool.h"
#include "gpu/transfer/upload.h"
#include "support/error_of.h"
#include "support/gpu.h"
#include "support/handmade_device.h"
#include "support/upload_buffer.h"

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
  test::uploadBuffer(testDevice(), buffer, 0, expected);
  const Bytes part = pattern(333, 2);
  test::uploadBuffer(testDevice(), buffer, 77, part);
  std::copy(part.begin(), part.end(), expected.begin() + 77);
  test::uploadBuffer(testDevice(), buffer, 1000, {});
  CHECK(readBuffer(testDevice(), buffer) == expected);
}

TEST_CASE("uploads larger than the staging buffer arrive completely") {
  const Bytes bytes = pattern((std::size_t(5) << 20) + 13, 3);
  const Buffer buffer = deviceBuffer(bytes.size());
  const VkExtent2D extent{701, 1001};  // 2.7 MiB: three pieces, none of a divisor's size
  const Bytes pixels = pattern(std::size_t(4) * extent.width * extent.height, 4);
  const GpuImage image = texture(VK_FORMAT_R8G8B8A8_UNORM, extent);
  Uploader uploader(testDevice(), nullptr, 1);  // raised to the minimum
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

TEST_CASE("levels and layers of an image announced as a whole are uploaded in pieces, in any order") {
  const VkExtent2D extent{600, 301};  // 0.7 MiB: several staging buffers
  const GpuImage image = texture(VK_FORMAT_R8G8B8A8_UNORM, extent, 3, 10);
  const auto levelExtent = [&](std::uint32_t level) {
    return VkExtent2D{std::max(1u, extent.width >> level), std::max(1u, extent.height >> level)};
  };
  const auto levelBytes = [&](std::uint32_t layer, std::uint32_t level) {
    return pattern(std::size_t(4) * levelExtent(level).width * levelExtent(level).height, 10 * layer + level);
  };
  const bool collected = GENERATE(false, true);
  CAPTURE(collected);
  Uploads uploads(testDevice());
  Uploader uploader(testDevice(), collected ? &uploads : nullptr, 1);
  uploader.beginImage(image);
  for (std::uint32_t layer = 3; layer-- > 0;)
    for (std::uint32_t level = 0; level < 10; ++level)
      uploader.image(image, layer, level, levelExtent(level), levelBytes(layer, level));
  uploader.flush();
  if (collected) submitAndWait(testDevice(), [&](VkCommandBuffer commands) { uploads.record(commands); });
  for (std::uint32_t layer = 0; layer < 3; ++layer)
    for (std::uint32_t level = 0; level < 10; ++level)
      CHECK(read(image, levelExtent(level), 4, layer, level) == levelBytes(layer, level));
}

TEST_CASE("block-compressed levels of any size are uploaded", "[bc]") {
  if (!testDevice().supportsBlockCompression()) return;
  const VkExtent2D extent{13, 6};
  const GpuImage image = texture(VK_FORMAT_BC7_UNORM_BLOCK, extent, 1, 4);
  Uploader uploader(testDevice());
  std::vector<Bytes> levels;
  for (std::uint32_t level = 0; level < 4; ++level) {
    const VkExtent2D size{std::max(1u, extent.width >> level), std::max(1u, extent.height >> level)};
    levels.push_back(pattern(std::size_t(16) * ((size.width + 3) / 4) * ((size.height + 3) / 4), level));
    uploader.image(image, 0, level, size, levels.back());
  }
  uploader.flush();
  const Buffer blocks = deviceBuffer(levels[0].size());
  submitAndWait(testDevice(), [&](VkCommandBuffer commands) {
    transition(commands, image.get(), use::kSampled, use::kTransferSource);
    const VkBufferImageCopy region{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                   .imageExtent = {extent.width, extent.height, 1}};
    vkCmdCopyImageToBuffer(commands, image.get(), use::kTransferSource.layout, blocks.get(), 1, &region);
  });
  CHECK(readBuffer(testDevice(), blocks) == levels[0]);
}

TEST_CASE("collected uploads are recorded in order, more than once, and dropped") {
  const Buffer buffer = deviceBuffer(64), large = deviceBuffer((VkDeviceSize(5) << 20) + 13);
  const GpuImage image = texture(VK_FORMAT_R8_UNORM, {64, 64});
  Bytes expected = pattern(64, 1);
  const Bytes part = pattern(40, 2), bytes = pattern(large.size(), 3), pixels = pattern(4096, 4);
  Uploads uploads(testDevice());
  CHECK(uploads.empty());
  CHECK(uploads.bytes() == 0);
  {
    Uploader uploader(testDevice(), &uploads);
    uploader.buffer(buffer, 0, expected);
    uploader.image(image, 0, 0, {64, 64}, pattern(4096, 5));
    uploader.buffer(buffer, 8, part);  // overlaps the first one
    uploader.image(image, 0, 0, {64, 64}, pixels);
    uploader.buffer(large, 0, bytes);
    CHECK(uploads.empty());
    uploader.flush();
  }
  std::copy(part.begin(), part.end(), expected.begin() + 8);
  CHECK_FALSE(uploads.empty());
  CHECK(uploads.bytes() >= bytes.size());

  int records = 0;
  {
    Uploader uploader(testDevice(), &uploads);
    const auto zeros =
        std::make_shared<Buffer>(testDevice(), 4, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, MemoryKind::upload, "zeros");
    std::ranges::fill(zeros->mapped(), std::byte(0));
    uploader.commands([&, zeros](VkCommandBuffer commands) {
      ++records;
      const VkBufferCopy region{0, 60, 4};
      vkCmdCopyBuffer(commands, zeros->get(), buffer.get(), 1, &region);
      bufferBarrier(commands, use::kTransferWrite, use::kAllCommands);
    });
    uploader.flush();
  }
  std::fill(expected.begin() + 60, expected.end(), std::byte(0));
  const auto expectUploaded = [&] {
    CHECK(readBuffer(testDevice(), buffer) == expected);
    CHECK(readBuffer(testDevice(), large) == bytes);
    CHECK(read(image, {64, 64}, 1) == pixels);
  };
  submitAndWait(testDevice(), [&](VkCommandBuffer commands) {
    uploads.record(commands);
    uploads.record(commands);
  });
  CHECK(records == 2);
  expectUploaded();
  test::uploadBuffer(testDevice(), buffer, 0, pattern(64, 9));
  submitAndWait(testDevice(), [&](VkCommandBuffer commands) { uploads.record(commands); });
  expectUploaded();

  uploads.clear();
  CHECK(uploads.empty());
  CHECK(uploads.bytes() == 0);
  submitAndWait(testDevice(), [&](VkCommandBuffer commands) { uploads.record(commands); });
  CHECK(records == 3);
}

TEST_CASE("uploads that were not flushed are dropped, with and without Uploads") {
  const Buffer buffer = deviceBuffer(64);
  const Bytes expected = pattern(64, 1);
  test::uploadBuffer(testDevice(), buffer, 0, expected);
  Uploads uploads(testDevice());
  for (Uploads* into : {static_cast<Uploads*>(nullptr), &uploads})
    Uploader(testDevice(), into).buffer(buffer, 0, pattern(64, 2));
  CHECK(uploads.empty());
  CHECK(uploads.bytes() == 0);
  submitAndWait(testDevice(), [&](VkCommandBuffer commands) { uploads.record(commands); });
  CHECK(readBuffer(testDevice(), buffer) == expected);
}

TEST_CASE("a staging pool gives pieces that do not overlap, and has no room where they fill it") {
  StagingPool pool(testDevice(), 256, 16);
  std::vector<StagingPool::Piece> pieces;
  for (int i = 0; i < 8; ++i) {
    pieces.push_back(pool.take(20).value());
    CHECK(pieces.back().offset == VkDeviceSize(32 * i));  // aligned pieces
    CHECK(pieces.back().memory.size() == 20);
  }
  CHECK_FALSE(pool.take(1));
  pool.release(pieces[2]);
  pool.release(pieces[5]);
  CHECK_FALSE(pool.take(33));
  pool.release(pieces[3]);
  CHECK(pool.take(64).value().offset == 64);
  CHECK(pool.take(32).value().offset == 160);
  CHECK_FALSE(pool.take(1));
}

TEST_CASE("a staging pool frees the pieces of a frame once the frame has finished") {
  StagingPool pool(testDevice(), 256, 16);
  const StagingPool::Piece first = pool.take(128).value(), second = pool.take(64).value();
  const StagingPool::Piece third = pool.take(64).value();
  pool.releaseAfter(second, 4);
  pool.releaseAfter(first, 5);
  pool.release(3);
  CHECK_FALSE(pool.take(1));
  pool.release(4);
  CHECK_FALSE(pool.take(65));
  CHECK(pool.take(64).value().offset == 128);
  pool.release(100);  // the third and the fourth piece were not released
  CHECK(pool.take(128).value().offset == 0);
  CHECK_FALSE(pool.take(1));
  pool.release(third);
  CHECK(pool.take(64).value().offset == 192);
}

TEST_CASE("a staging pool has no room where too many pieces are in use") {
  StagingPool pool(testDevice(), 1 << 20, 3);
  for (int i = 0; i < 3; ++i) pool.releaseAfter(pool.take(16).value(), 1);
  CHECK_FALSE(pool.take(16));
  pool.release(1);
  CHECK(pool.take(1 << 20).value().offset == 0);
}

TEST_CASE("uploads of another device are refused") {
  const test::HandmadeDevice handmade;
  const Device other = Device::adopt(handmade.handles());
  Uploads uploads(other);
  const Error error = test::errorOf([&] { Uploader(testDevice(), &uploads); });
  CHECK(error.code() == ErrorCode::invalidInput);
  CHECK_THAT(error.what(), Catch::Contains("another device"));
}

TEST_CASE("buffers and images can be moved") {
  const Bytes bytes = pattern(64, 7);
  Buffer a = deviceBuffer(64);
  test::uploadBuffer(testDevice(), a, 0, bytes);
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
