// SPDX-License-Identifier: Apache-2.0
// Tests with the runtime's real compositor, in a window of a virtual display. They check the visible result, which the
// null compositor cannot show.
#include <cmath>
#include <glm/common.hpp>

#include "apps/support/virtual_display.h"
#include "apps/support/x11_window.h"
#include "io/image_file.h"
#include "vr_harness.h"

using namespace ibr;
using namespace ibr::test;

namespace {

constexpr int kWidth = 480, kHeight = 540;  // of half the compositor's window
constexpr int kBlock = 20;                  // px, side of the squares whose colours are compared

std::string compositorWindow(Visitor& visitor) {
  std::string found;
  const bool came = visitor.program().runsUntil([&] {
    try {
      found = xdotool({"search", "--onlyvisible", "--name", "^Monado$"});
    } catch (const std::runtime_error&) {  // no window yet
    }
    return !found.empty();
  });
  INFO(visitor.program().err());
  REQUIRE(came);
  return found.substr(0, found.find('\n'));
}

// Mean colour of a square of kBlock × kBlock px, by channel.
glm::dvec3 meanOf(const Image8& image, int left, int top) {
  glm::dvec3 sum(0);
  for (int y = top; y < top + kBlock; ++y)
    for (int x = left; x < left + kBlock; ++x)
      for (int c = 0; c < 3; ++c) sum[c] += image.pixel(x, y)[std::size_t(c)];
  return sum / double(kBlock * kBlock);
}

// An eye's image resampled to another field of view; black outside the image.
Image8 seenIn(const RemoteFov& to, const Image8& picture, const RemoteFov& from) {
  Image8 seen(kWidth, kHeight, 3);
  const auto place = [](double pixel, int size, double first, double last, double newFirst, double newLast, int count) {
    const double tangent = std::tan(first) + (pixel + 0.5) / size * (std::tan(last) - std::tan(first));
    return int(std::floor((tangent - std::tan(newFirst)) / (std::tan(newLast) - std::tan(newFirst)) * count));
  };
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const int fromX = place(x, kWidth, to.left, to.right, from.left, from.right, picture.width);
      const int fromY = place(y, kHeight, to.up, to.down, from.up, from.down, picture.height);
      if (fromX >= 0 && fromX < picture.width && fromY >= 0 && fromY < picture.height)
        std::ranges::copy(picture.pixel(fromX, fromY), seen.pixel(x, y).begin());
    }
  return seen;
}

// Largest difference between the mean colours of a half of the window and of the expected image.
double difference(const Image8& window, int half, const Image8& expected) {
  double largest = 0;
  for (int y = 0; y < kHeight; y += kBlock)
    for (int x = 0; x < kWidth; x += kBlock) {
      const glm::dvec3 d = glm::abs(meanOf(window, half * kWidth + x, y) - meanOf(expected, x, y));
      largest = std::max({largest, d.x, d.y, d.z});
    }
  return largest;
}

// Fields of view of the compositor, used while the headset has no eyes of its own.
RemoteFov shownFov(const XrSetup& setup) {
  const auto fov = shownFrames(setup).back()["layers"][0]["views"][0]["fov"].get<std::array<double, 4>>();
  return {fov[0], fov[1], fov[2], fov[3]};
}

// Checks the window, optionally with faults of the runtime.
void checkWindow(const std::string& faults) {
  XrSetup setup("odd-size=480x540" + faults, XrCompositor::window);
  Visitor visitor(setup,
                  {"--no-governor", "--no-floor", "--screenshots", setup.folder().path(), "--screenshot-every", "5"});
  RemoteState state = lookingAhead();
  state.ownEyes = false;
  visitor.move(state);
  const RemoteFov fov = shownFov(setup);
  state.ownEyes = true;
  state.eyes[0].fov = {-0.9, 0.4, 0.6, -0.6};
  state.eyes[1].fov = {-0.4, 0.9, 0.55, -0.6};
  visitor.move(state);
  visitor.waitForScene();
  visitor.pass(12);
  const Image8 window = pixelsOf(compositorWindow(visitor));
  const std::array pictures = lastPictures(setup.folder().path());
  visitor.leave();
  REQUIRE(window.width == 2 * kWidth);
  REQUIRE(window.height == kHeight);
  const Image8 left = seenIn(fov, readImage(pictures[0]), state.eyes[0].fov);
  const Image8 right = seenIn(fov, readImage(pictures[1]), state.eyes[1].fov);
  CHECK(difference(window, 0, left) < 16);
  CHECK(difference(window, 1, right) < 16);
  CHECK(difference(window, 0, right) > 64);
  CHECK(difference(window, 1, left) > 64);
}

}  // namespace

TEST_CASE("the compositor shows each eye's image in the drawn directions") {
  if (displayIsThere()) checkWindow("");
}

TEST_CASE("formats treated as linear show the same colours") {
  if (displayIsThere()) checkWindow(",formats=97:126");
}
