// SPDX-License-Identifier: Apache-2.0
#include "ibr/offscreen.h"

#include <catch2/catch.hpp>
#include <stdexcept>

#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"
#include "ibr/error.h"
#include "support/gpu.h"

using namespace ibr;
using Catch::Matchers::Contains;
using test::testDevice;

namespace {

/// Fills the target with one colour by a transfer, as a caller with own commands does.
Image8 cleared(Offscreen& offscreen, const std::array<float, 4>& rgba) {
  return offscreen.render([&](VkCommandBuffer commands) {
    const Target target = offscreen.target();
    transition(commands, target.image, target.initialUse, use::kTransferDestination);
    const VkClearColorValue value{{rgba[0], rgba[1], rgba[2], rgba[3]}};
    const VkImageSubresourceRange range{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    vkCmdClearColorImage(commands, target.image, use::kTransferDestination.layout, &value, 1, &range);
    transition(commands, target.image, use::kTransferDestination, target.finalUse);
  });
}

ErrorCode codeOf(VkExtent2D extent, VkFormat format, const char* text) {
  try {
    Offscreen(testDevice(), extent, format);
  } catch (const Error& error) {
    CHECK_THAT(error.what(), Contains(text));
    return error.code();
  }
  FAIL("no error");
  return {};
}

}  // namespace

TEST_CASE("images are read back as RGBA in every format") {
  struct Case {
    VkFormat format;
    int half;  // stored value of 0.5
  };
  const auto [format, half] = GENERATE(Case{VK_FORMAT_R8G8B8A8_UNORM, 128}, Case{VK_FORMAT_B8G8R8A8_UNORM, 128},
                                       Case{VK_FORMAT_R8G8B8A8_SRGB, 188}, Case{VK_FORMAT_B8G8R8A8_SRGB, 188});
  CAPTURE(format);
  Offscreen offscreen(testDevice(), {5, 3}, format);
  CHECK(offscreen.target().format == format);
  const Image8 picture = cleared(offscreen, {1.0f, 0.5f, 0.0f, 0.2f});
  REQUIRE(picture.width == 5);
  REQUIRE(picture.height == 3);
  REQUIRE(picture.channels == 4);
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 5; ++x) {
      const auto pixel = picture.pixel(x, y);
      CHECK(int(pixel[0]) == 255);
      CHECK(std::abs(int(pixel[1]) - half) <= 1);  // drivers may round 127.5 to either side
      CHECK(int(pixel[2]) == 0);
      CHECK(int(pixel[3]) == 51);
    }
}

TEST_CASE("an offscreen image can be reused and moved") {
  Offscreen a(testDevice(), {2, 2});
  CHECK(int(cleared(a, {1, 0, 0, 0}).values[0]) == 255);
  CHECK(int(cleared(a, {0, 1, 0, 0}).values[0]) == 0);
  Offscreen b = std::move(a);
  CHECK(int(cleared(b, {0, 1, 0, 0}).values[1]) == 255);
  Offscreen c(testDevice(), {9, 9});
  c = std::move(b);
  CHECK(cleared(c, {0, 0, 1, 0}).width == 2);
}

TEST_CASE("an exception of the recording callback is passed on, and the next image works") {
  Offscreen offscreen(testDevice(), {2, 2});
  CHECK_THROWS_AS(offscreen.render([](VkCommandBuffer) { throw std::logic_error("stop"); }), std::logic_error);
  CHECK(int(cleared(offscreen, {0, 0, 1, 0}).values[2]) == 255);
}

TEST_CASE("empty extents and unsupported formats are refused") {
  CHECK(codeOf({0, 4}, VK_FORMAT_R8G8B8A8_UNORM, "0×4") == ErrorCode::invalidInput);
  CHECK(codeOf({4, 0}, VK_FORMAT_R8G8B8A8_UNORM, "4×0") == ErrorCode::invalidInput);
  CHECK(codeOf({4, 4}, VK_FORMAT_R16G16B16A16_SFLOAT, "VkFormat 97") == ErrorCode::unsupported);
  CHECK(codeOf({1u << 30, 4}, VK_FORMAT_R8G8B8A8_UNORM, "width 1073741824") == ErrorCode::unsupported);
  CHECK(codeOf({4, 1u << 30}, VK_FORMAT_R8G8B8A8_UNORM, "height 1073741824") == ErrorCode::unsupported);
}
