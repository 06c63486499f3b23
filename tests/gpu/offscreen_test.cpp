// SPDX-License-Identifier: Apache-2.0
#include "ibr/offscreen.h"

#include <catch2/catch.hpp>
#include <stdexcept>

#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"
#include "ibr/error.h"
#include "support/gpu.h"

using namespace ibr;
using Catch::Contains;
using test::testDevice;

namespace {

/// Fills the target with one colour by a transfer, as a caller with own commands does.
void clear(VkCommandBuffer commands, const Target& target, const std::array<float, 4>& rgba) {
  transition(commands, target.image, target.initialUse, use::kTransferDestination);
  const VkClearColorValue value{{rgba[0], rgba[1], rgba[2], rgba[3]}};
  const VkImageSubresourceRange range{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  vkCmdClearColorImage(commands, target.image, use::kTransferDestination.layout, &value, 1, &range);
  transition(commands, target.image, use::kTransferDestination, target.finalUse);
}
Image8 cleared(Offscreen& offscreen, const std::array<float, 4>& rgba) {
  return offscreen.render([&](VkCommandBuffer commands) { clear(commands, offscreen.target(), rgba); });
}
ImageF clearedFloat(Offscreen& offscreen, const std::array<float, 4>& rgba) {
  return offscreen.renderFloat([&](VkCommandBuffer commands) { clear(commands, offscreen.target(), rgba); });
}

ErrorCode codeOf(VkExtent2D extent, TargetFormat format, const char* text) {
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

TEST_CASE("images of every format are read back as floats") {
  struct Case {
    TargetFormat format;
    double half;   // stored value of 0.5
    double steps;  // of colours from 0 to 1
    double alpha;  // stored value of 0.2
  };
  const auto [format, half, steps, alpha] = GENERATE(
      Case{VK_FORMAT_R8G8B8A8_UNORM, 0.5, 255, 0.2}, Case{VK_FORMAT_B8G8R8A8_UNORM, 0.5, 255, 0.2},
      Case{VK_FORMAT_R8G8B8A8_SRGB, 188 / 255.0, 255, 0.2}, Case{VK_FORMAT_B8G8R8A8_SRGB, 188 / 255.0, 255, 0.2},
      Case{VK_FORMAT_A2B10G10R10_UNORM_PACK32, 0.5, 1023, 1 / 3.0},
      Case{{VK_FORMAT_A2B10G10R10_UNORM_PACK32, Encoding::linear}, 0.5, 1023, 1 / 3.0},
      Case{VK_FORMAT_R16G16B16A16_SFLOAT, 0.5, 1e6, 0.2},
      Case{{VK_FORMAT_R16G16B16A16_SFLOAT, Encoding::linear}, 0.5, 1e6, 0.2});
  CAPTURE(format.format, int(format.encoding));
  Offscreen offscreen(testDevice(), {5, 3}, format);
  CHECK(offscreen.target().format == format.format);
  CHECK(offscreen.target().encoding == format.encoding);
  const ImageF picture = clearedFloat(offscreen, {1.0f, 0.5f, 0.0f, 0.2f});
  REQUIRE(picture.width == 5);
  REQUIRE(picture.height == 3);
  REQUIRE(picture.channels == 4);
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 5; ++x) {
      const auto pixel = picture.pixel(x, y);
      CHECK(pixel[0] == 1);
      CHECK(pixel[1] == Approx(half).margin(1 / steps));
      CHECK(pixel[2] == 0);
      CHECK(pixel[3] == Approx(alpha).margin(1e-3));
    }
}

TEST_CASE("half floats beyond 0 to 1 are read back, and other formats clamp them") {
  const std::array<float, 4> values{1000.5f, -2.0f, 65504.0f, -0.25f};  // each is a half float
  Offscreen wide(testDevice(), {2, 2}, {VK_FORMAT_R16G16B16A16_SFLOAT, Encoding::linear});
  const ImageF kept = clearedFloat(wide, values);
  for (std::size_t c = 0; c < 4; ++c) CHECK(kept.values[c] == values[c]);
  Offscreen tenBits(testDevice(), {2, 2}, VK_FORMAT_A2B10G10R10_UNORM_PACK32);
  const ImageF clamped = clearedFloat(tenBits, values);
  for (std::size_t c = 0; c < 4; ++c) CHECK(clamped.values[c] == (values[c] > 0 ? 1 : 0));
}

TEST_CASE("an 8-bit image of a wider format is refused before anything is recorded") {
  for (const VkFormat format : {VK_FORMAT_R16G16B16A16_SFLOAT, VK_FORMAT_A2B10G10R10_UNORM_PACK32}) {
    Offscreen offscreen(testDevice(), {2, 2}, format);
    bool recorded = false;
    CHECK_THROWS_WITH(offscreen.render([&](VkCommandBuffer) { recorded = true; }), Contains("renderFloat"));
    CHECK_FALSE(recorded);
    CHECK(clearedFloat(offscreen, {1, 0, 0, 1}).values[0] == 1);
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
  CHECK(codeOf({4, 4}, VK_FORMAT_R32G32B32A32_SFLOAT, "VkFormat 109") == ErrorCode::unsupported);
  CHECK(codeOf({4, 4}, {VK_FORMAT_R8G8B8A8_UNORM, Encoding::linear}, "linear") == ErrorCode::unsupported);
  CHECK(codeOf({1u << 30, 4}, VK_FORMAT_R8G8B8A8_UNORM, "width 1073741824") == ErrorCode::unsupported);
  CHECK(codeOf({4, 1u << 30}, VK_FORMAT_R8G8B8A8_UNORM, "height 1073741824") == ErrorCode::unsupported);
}
