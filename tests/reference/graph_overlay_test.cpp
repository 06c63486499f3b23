// SPDX-License-Identifier: Apache-2.0
// The image graph drawn as lines over an image, compared with lines in double precision.
#include "ibr/graph_overlay.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"
#include "ibr/error.h"
#include "reference/stage.h"
#include "reference/stored_colours.h"
#include "shared/overlay.h"
#include "support/gpu.h"

using namespace ibr;
using namespace ibr::test;

namespace {

constexpr double kDepth = 0.4;
constexpr std::uint8_t kBlue = 90, kAlpha = 77;  // of the image below the lines

// Three pinholes, the first two in one cell, and a panorama, all in front of the view.
ImageGraph graph() {
  ImageGraph all;
  all.photographs = {cameraAt({-1, 0, -4}, 0.3), cameraAt({0.2, 0.1, -5}, -0.2, 0.1, 240, 360),
                     cameraAt({1.2, -0.4, -6}), cameraAt({0.4, 1, -4})};
  all.photographs[3].intrinsics = {CameraModel::equirectangular, 64, 32};
  all.cells = {{0, 1}};
  return all;
}

template <class T>
using Picture = Image<T> (Offscreen::*)(const std::function<void(VkCommandBuffer)>&);

template <class T>
Image<T> drawn(const ImageGraph& all, const Camera& view, const std::vector<std::uint32_t>& best, TargetFormat format,
               Picture<T> picture) {
  const VkExtent2D extent{std::uint32_t(view.intrinsics.width), std::uint32_t(view.intrinsics.height)};
  const GraphOverlay overlay(testDevice(), all, {.frustumDepth = kDepth, .formats = {format}});
  Offscreen offscreen(testDevice(), extent, format);
  return (offscreen.*picture)([&](VkCommandBuffer commands) {
    Target target = offscreen.target();
    transition(commands, target.image, use::kUndefined, use::kTransferDestination);
    const VkClearColorValue blue{.float32 = {0, 0, kBlue / 255.0f, kAlpha / 255.0f}};
    const VkImageSubresourceRange whole{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    vkCmdClearColorImage(commands, target.image, use::kTransferDestination.layout, &blue, 1, &whole);
    target.initialUse = use::kTransferDestination;
    overlay.record(commands, view, best, target);
  });
}

Image8 drawn(const ImageGraph& all, const Camera& view, const std::vector<std::uint32_t>& best,
             VkFormat format = VK_FORMAT_R8G8B8A8_UNORM) {
  return drawn(all, view, best, format, &Offscreen::render);
}

struct Segment {
  glm::dvec3 from, to;
};

// Edges of a camera's frustum: four from the centre and four of the image rectangle, without the upper mark.
std::vector<Segment> frustum(const Camera& camera) {
  std::vector<glm::dvec3> corners;
  for (const glm::dvec2 corner : {glm::dvec2(0, 0), glm::dvec2(1, 0), glm::dvec2(1, 1), glm::dvec2(0, 1)}) {
    const glm::dvec2 pixel = corner * glm::dvec2(camera.intrinsics.width, camera.intrinsics.height);
    corners.push_back(camera.pose.position +
                      camera.pose.rotation * (kDepth * glm::normalize(unproject(camera.intrinsics, pixel))));
  }
  std::vector<Segment> edges;
  for (std::size_t i = 0; i < 4; ++i) {
    edges.push_back({camera.pose.position, corners[i]});
    edges.push_back({corners[i], corners[(i + 1) % 4]});
  }
  return edges;
}

// Distance, px, of a pixel from a segment's middle line. Infinite if the segment is not fully in front of the view.
double pixelsTo(const Camera& view, const Segment& s, glm::dvec2 pixel) {
  const auto seen = [&](glm::dvec3 p) {
    return project(view.intrinsics, glm::conjugate(view.pose.rotation) * (p - view.pose.position));
  };
  const auto a = seen(s.from), b = seen(s.to);
  if (!a || !b) return std::numeric_limits<double>::infinity();
  const glm::dvec2 along = *b - *a;
  const double t = std::clamp(glm::dot(pixel - *a, along) / std::max(glm::dot(along, along), 1e-12), 0.0, 1.0);
  return glm::distance(pixel, *a + t * along);
}

std::size_t untouched(const Image8& picture) {
  std::size_t count = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const auto p = picture.pixel(x, y);
      count += p[0] == 0 && p[1] == 0 && p[2] == kBlue;
    }
  return count;
}

int largestDifference(const Image8& a, const Image8& b) {
  int most = 0;
  for (std::size_t i = 0; i < a.values.size(); ++i) most = std::max(most, std::abs(a.values[i] - b.values[i]));
  return most;
}

}  // namespace

TEST_CASE("lines of a drawn cell and its photographs have its rank's colour, and other pixels are unchanged") {
  const ImageGraph all = graph();
  const Camera view = cameraAt({0, 0, 0});
  const Image8 picture = drawn(all, view, {0});
  std::vector<Segment> best = frustum(all.photographs[0]);
  for (const Segment& edge : frustum(all.photographs[1])) best.push_back(edge);
  best.push_back({all.photographs[0].pose.position, all.photographs[1].pose.position});
  const std::vector<Segment> other = frustum(all.photographs[2]);
  const shader::vec3 yellow = shader::rankColour(0, 1);

  std::size_t on = 0, grey = 0, wrongOn = 0, wrongGrey = 0, wrongAlpha = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const auto p = picture.pixel(x, y);
      wrongAlpha += p[3] != kAlpha;
      const auto nearest = [&](const std::vector<Segment>& lines) {
        double least = 1e9;
        for (const Segment& s : lines) least = std::min(least, pixelsTo(view, s, {x + 0.5, y + 0.5}));
        return least;
      };
      const double toBest = nearest(best), toOther = nearest(other);
      if (toBest < 0.25) {
        ++on;
        for (int c = 0; c < 3; ++c) wrongOn += std::abs(p[c] - 255 * yellow[c]) > 2;
      } else if (toOther < 0.25 && toBest > 4) {
        ++grey;  // faint line: 0.4 of 0.75, more where such lines cross
        wrongGrey += p[0] < 255 * 0.3 - 2 || p[0] > 170 || p[1] != p[0];
      }
    }
  CHECK(on > 100);
  CHECK(wrongOn == 0);
  CHECK(grey > 20);
  CHECK(wrongGrey == 0);
  CHECK(wrongAlpha == 0);
  // The strip of each line is less than seven pixels wide.
  CHECK(untouched(picture) > picture.values.size() / 4 * 8 / 10);
}

TEST_CASE("without drawn cells all lines are faint, and a panorama is a globe") {
  ImageGraph all = graph();
  all.photographs = {all.photographs[3]};
  all.cells.clear();
  const Camera view = cameraAt({0, 0, 0});
  const Image8 picture = drawn(all, view, {});
  const glm::dvec3 place = all.photographs[0].pose.position;
  const glm::dvec2 centre = *project(view.intrinsics, place - view.pose.position);
  const double radius = 0.5 * kDepth / -place.z * view.intrinsics.fx;
  std::size_t touched = 0;
  double furthest = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      if (picture.pixel(x, y)[0] > 30) {
        ++touched;
        CHECK(picture.pixel(x, y)[0] < 200);
        furthest = std::max(furthest, glm::distance(glm::dvec2(x + 0.5, y + 0.5), centre));
      }
  CHECK(touched > 30);
  CHECK(furthest > 0.9 * radius);
  CHECK(furthest < 1.2 * radius + 2);
}

TEST_CASE("lines are the same after moving the world and in each format") {
  const ImageGraph all = graph();
  const Camera view = cameraAt({0.1, 0.05, 0.3}, 0.05);
  const Image8 picture = drawn(all, view, {0});
  const glm::dvec3 away(4e6, -2e6, 1e6);
  ImageGraph moved = all;
  for (Camera& camera : moved.photographs) camera.pose.position += away;
  Camera movedView = view;
  movedView.pose.position += away;
  CHECK(largestDifference(drawn(moved, movedView, {0}), picture) <= 2);
  CHECK(drawn(all, view, {0}, VK_FORMAT_B8G8R8A8_UNORM).values == picture.values);
  // Blending in sRGB makes seams lighter or darker, but does not change lines.
  const Image8 encoded = drawn(all, view, {0}, VK_FORMAT_R8G8B8A8_SRGB);
  const shader::vec3 yellow = shader::rankColour(0, 1);
  std::size_t on = 0;
  for (int y = 0; y < encoded.height; ++y)
    for (int x = 0; x < encoded.width; ++x) {
      bool same = true;
      for (int c = 0; c < 3; ++c) same &= std::abs(encoded.pixel(x, y)[c] - 255 * yellow[c]) <= 3;
      on += same;
    }
  CHECK(on > 100);
}

TEST_CASE("wide formats show the lines of the 8-bit format that blends the same values") {
  const ImageGraph all = graph();
  const Camera view = cameraAt({0.1, 0.05, 0.3}, 0.05);
  struct Row {
    TargetFormat wide;
    VkFormat likewise;  // 8-bit format that blends display-encoded values, or linear light
  };
  for (const Row& row : {Row{VK_FORMAT_R16G16B16A16_SFLOAT, VK_FORMAT_R8G8B8A8_UNORM},
                         Row{VK_FORMAT_A2B10G10R10_UNORM_PACK32, VK_FORMAT_R8G8B8A8_UNORM},
                         Row{{VK_FORMAT_R16G16B16A16_SFLOAT, Encoding::linear}, VK_FORMAT_R8G8B8A8_SRGB}}) {
    CAPTURE(row.wide.format, int(row.wide.encoding));
    const Image8 picture = drawn(all, view, {0}, row.likewise);
    const ImageF seen = drawn(all, view, {0}, row.wide, &Offscreen::renderFloat);
    // Each of several lines over a pixel rounds the 8-bit value once more.
    CHECK(wrongChannels(seen, picture, row.wide, 3) < picture.values.size() / 1000);
    CHECK(wrongChannels(seen, Image8(picture.width, picture.height, 4), row.wide, 3) > picture.values.size() / 10);
  }
}

TEST_CASE("lines through the eye or behind it do not fill the image") {
  const ImageGraph all = graph();
  Camera behind = cameraAt({0, 0, -9});
  CHECK(untouched(drawn(all, behind, {0})) == 320 * 240);  // everything is behind the view
  Camera at = cameraAt({0, 0, 0});
  at.pose.position = all.photographs[0].pose.position;  // five lines end at the view's position
  CHECK(untouched(drawn(all, at, {0})) > 320 * 240 / 2);
  at.pose.position = 0.5 * (all.photographs[0].pose.position + all.photographs[1].pose.position);  // on the cell's line
  CHECK(untouched(drawn(all, at, {0})) > 320 * 240 / 2);
}

TEST_CASE("a line from behind the eye is clipped to its part in front") {
  ImageGraph all;
  all.photographs = {cameraAt({-0.5, -0.4, 3}), cameraAt({0.3, 0.2, -5})};
  all.cells = {{0, 1}};
  const Camera view = cameraAt({0, 0, 0});
  const Image8 picture = drawn(all, view, {0});
  const shader::vec3 yellow = shader::rankColour(0, 1);
  const glm::dvec3 from = all.photographs[0].pose.position, to = all.photographs[1].pose.position;
  std::size_t seen = 0, wrong = 0;
  for (double t = 0; t < 0.9; t += 0.001) {
    const glm::dvec3 point = glm::mix(from, to, t);
    const auto pixel = project(view.intrinsics, point);
    if (-point.z < 2 * kDepth || !pixel || glm::any(glm::lessThan(*pixel, glm::dvec2(1))) || pixel->x > 319 ||
        pixel->y > 239)
      continue;
    ++seen;
    wrong += std::abs(picture.pixel(int(pixel->x), int(pixel->y))[0] - 255 * yellow.x) > 120;  // line edge
  }
  CHECK(seen > 100);
  CHECK(wrong == 0);
  // All of the line in front of the view appears to the lower left of its end.
  const glm::dvec2 end = *project(view.intrinsics, to);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      if (std::min(x - end.x, end.y - y) > 25) CHECK(picture.pixel(x, y)[0] == 0);
}

TEST_CASE("invalid graphs are refused by field and index") {
  ImageGraph all = graph();
  const auto made = [&](GraphOverlayOptions options = {}) { GraphOverlay(testDevice(), all, options); };
  CHECK_NOTHROW(made());
  CHECK_THROWS_WITH(made({.frustumDepth = 0}), Catch::Contains("frustumDepth"));
  CHECK_THROWS_WITH(made({.formats = {VK_FORMAT_R32G32B32A32_SFLOAT}}), Catch::Contains("VkFormat"));
  CHECK_THROWS_WITH(made({.formats = {{VK_FORMAT_R8G8B8A8_SRGB, Encoding::linear}}}),
                    Catch::Contains("display-encoded"));
  all.cells = {{0, 1}, {2, 4}};
  CHECK_THROWS_WITH(made(), Catch::Contains("cells[1]") && Catch::Contains("4"));
  all = graph();
  all.photographs[2].pose.position.y = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH(made(), Catch::Contains("photographs[2]"));
  all = {};
  CHECK(untouched(drawn(all, cameraAt({0, 0, 0}), {})) == 320 * 240);
}
