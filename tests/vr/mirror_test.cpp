// SPDX-License-Identifier: Apache-2.0
// The mirror window: exact values of the eye's image, uncropped and centred.
#include "vr/menu/mirror.h"

#include <array>
#include <catch2/catch.hpp>
#include <cstring>
#include <utility>

#include "base/vulkan/barrier.h"
#include "base/vulkan/buffer.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/submit.h"
#include "ibr/error.h"
#include "ibr/offscreen.h"
#include "support/gpu.h"

using namespace ibr;
using namespace ibr::app;
using namespace ibr::test;

namespace {

using Rgb = std::array<int, 3>;

constexpr Rgb kBar{28, 31, 33};

// Test value of a pixel. Dark values are included, because a second encoding would change them most.
Rgb valueAt(std::uint32_t x, std::uint32_t y, std::uint32_t layer) {
  return {int(x * 5 % 256), int(y * 7 % 256), int((x + y) * 3 % 128 + 100 * layer)};
}

GpuImage makeEyes(VkFormat format, VkExtent2D extent, bool flat) {
  const Device& device = testDevice();
  GpuImage eyes(
      device,
      {.format = format,
       .extent = extent,
       .layers = 2,
       .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT,
       .viewType = VK_IMAGE_VIEW_TYPE_2D_ARRAY},
      "eyes");
  Buffer bytes(device, VkDeviceSize(extent.width) * extent.height * 8, VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
               MemoryKind::upload, "eyes' values");
  const bool blueFirst = format == VK_FORMAT_B8G8R8A8_SRGB || format == VK_FORMAT_B8G8R8A8_UNORM;
  std::size_t at = 0;
  for (std::uint32_t layer = 0; layer < 2; ++layer)
    for (std::uint32_t y = 0; y < extent.height; ++y)
      for (std::uint32_t x = 0; x < extent.width; ++x) {
        Rgb value = flat ? valueAt(3, 4, layer) : valueAt(x, y, layer);
        if (blueFirst) std::swap(value[0], value[2]);
        for (const int v : {value[0], value[1], value[2], 255}) bytes.mapped()[at++] = std::byte(v);
      }
  submitAndWait(device, [&](VkCommandBuffer commands) {
    const VkBufferImageCopy region{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 2},
                                   .imageExtent = {extent.width, extent.height, 1}};
    transition(commands, eyes.get(), use::kUndefined, use::kTransferDestination);
    vkCmdCopyBufferToImage(commands, bytes.get(), eyes.get(), use::kTransferDestination.layout, 1, &region);
    transition(commands, eyes.get(), use::kTransferDestination, use::kColourAttachment);
  });
  return eyes;
}

// Records twice, as successive frames do.
Image8 seen(const Mirror& mirror, const MirrorSource& source, VkExtent2D window, VkFormat format) {
  Offscreen frame(testDevice(), window, format);
  const Target target = frame.target();
  return frame.render([&](VkCommandBuffer commands) {
    for (int i = 0; i < 2; ++i) mirror.record(commands, source, {commands, target.image, target.view, 0, window});
  });
}

Rgb colourAt(const Image8& image, int x, int y) {
  const auto pixel = image.pixel(x, y);
  return {pixel[0], pixel[1], pixel[2]};
}

}  // namespace

TEST_CASE("the mirror shows the exact values of an eye's image for any formats") {
  const VkExtent2D extent{40, 30};
  for (const VkFormat eye : {VK_FORMAT_R8G8B8A8_SRGB, VK_FORMAT_B8G8R8A8_SRGB, VK_FORMAT_R8G8B8A8_UNORM})
    for (const VkFormat shown : {VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_B8G8R8A8_UNORM}) {
      const GpuImage eyes = makeEyes(eye, extent, false);
      const Mirror mirror(testDevice(), eye, extent);
      for (const std::uint32_t layer : {0u, 1u}) {
        const Image8 picture =
            seen(mirror, {.image = eyes.get(), .layer = layer, .rect = {{0, 0}, extent}}, extent, shown);
        Image8 wanted(40, 30, 4);
        for (int y = 0; y < 30; ++y)
          for (int x = 0; x < 40; ++x) {
            const Rgb value = valueAt(std::uint32_t(x), std::uint32_t(y), layer);
            for (std::size_t c = 0; c < 3; ++c) wanted.pixel(x, y)[c] = std::uint8_t(value[c]);
            wanted.pixel(x, y)[3] = 255;
          }
        CHECK((picture.values == wanted.values));
      }
    }
}

TEST_CASE("the mirror shows only the drawn part of an eye's image") {
  const GpuImage eyes = makeEyes(VK_FORMAT_R8G8B8A8_SRGB, {40, 30}, false);
  const Mirror mirror(testDevice(), VK_FORMAT_R8G8B8A8_SRGB, {40, 30});
  const Image8 picture =
      seen(mirror, {.image = eyes.get(), .layer = 1, .rect = {{10, 5}, {20, 10}}}, {20, 10}, VK_FORMAT_B8G8R8A8_UNORM);
  CHECK(colourAt(picture, 0, 0) == valueAt(10, 5, 1));
  CHECK(colourAt(picture, 19, 9) == valueAt(29, 14, 1));
}

TEST_CASE("the mirror shows the whole image with bars in a window of another aspect ratio") {
  const GpuImage eyes = makeEyes(VK_FORMAT_R8G8B8A8_SRGB, {32, 32}, true);
  const Mirror mirror(testDevice(), VK_FORMAT_R8G8B8A8_SRGB, {32, 32});
  const MirrorSource source{.image = eyes.get(), .rect = {{0, 0}, {32, 32}}};
  const Rgb value = valueAt(3, 4, 0);
  const Image8 wide = seen(mirror, source, {100, 64}, VK_FORMAT_B8G8R8A8_UNORM);
  CHECK(colourAt(wide, 17, 32) == kBar);
  CHECK(colourAt(wide, 18, 0) == value);
  CHECK(colourAt(wide, 81, 63) == value);
  CHECK(colourAt(wide, 82, 32) == kBar);
  const Image8 tall = seen(mirror, source, {16, 40}, VK_FORMAT_B8G8R8A8_UNORM);
  CHECK(colourAt(tall, 8, 11) == kBar);
  CHECK(colourAt(tall, 0, 12) == value);
  CHECK(colourAt(tall, 15, 27) == value);
  CHECK(colourAt(tall, 8, 28) == kBar);
}

TEST_CASE("the letterbox keeps the image's aspect ratio, down to one pixel") {
  const auto box = [](VkExtent2D picture, VkExtent2D window) {
    const VkRect2D r = letterbox(picture, window);
    return std::array<std::uint32_t, 4>{std::uint32_t(r.offset.x), std::uint32_t(r.offset.y), r.extent.width,
                                        r.extent.height};
  };
  CHECK(box({100, 50}, {100, 50}) == std::array{0u, 0u, 100u, 50u});
  CHECK(box({100, 50}, {200, 200}) == std::array{0u, 50u, 200u, 100u});
  CHECK(box({50, 100}, {200, 200}) == std::array{50u, 0u, 100u, 200u});
  CHECK(box({3, 2}, {100, 100}) == std::array{0u, 16u, 100u, 67u});
  CHECK(box({10000, 1}, {64, 64}) == std::array{0u, 31u, 64u, 1u});
  CHECK(box({1, 16384}, {16384, 16384}) == std::array{8191u, 0u, 1u, 16384u});
  CHECK(box({3, 2}, {1, 1}) == std::array{0u, 0u, 1u, 1u});
}

TEST_CASE("the mirror refuses formats that are not display-encoded") {
  CHECK_THROWS_AS(Mirror(testDevice(), VK_FORMAT_R16G16B16A16_SFLOAT, {8, 8}), Error);
}
