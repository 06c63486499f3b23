// SPDX-License-Identifier: Apache-2.0
// Visibility: a surface never has the colour of a camera that does not see it, with any HtmMethod.
#include <algorithm>
#include <catch2/catch.hpp>
#include <glm/gtc/quaternion.hpp>
#include <vector>

#include "reference/htm/htm_stage.h"

namespace ibr::test {
namespace {

constexpr double kAside = 0.75, kDistance = 4;
constexpr int kSize = 128;  // px, of all images
constexpr int kSide = 11;   // vertices of the wall in a row
constexpr HtmMethod kAll[]{HtmMethod::harmonised, HtmMethod::blended, HtmMethod::vertexColours};

// Camera in the plane y = 0 that looks at the origin.
Camera cameraAt(double angle, double distance) {
  Camera camera;
  camera.intrinsics = pinholeFromFov(kSize, kSize, 0.9);
  camera.pose.rotation = glm::angleAxis(angle, glm::dvec3(0, 1, 0));
  camera.pose.position = -distance * viewAxis(camera.pose);
  return camera;
}

// A wall in the plane z = 0, 2 × 2, and a screen of 0.6 × 0.6 in front of its middle. Camera 0 sees both head-on and is
// red. The two cameras beside it see behind the screen and are green and blue. All cameras are members everywhere.
struct Wall {
  HtmModel model;
  std::vector<HtmImage> pictures;
};

Wall wall() {
  Wall wall;
  TriangleMesh& mesh = wall.model.surface.mesh;
  const auto addGrid = [&](int side, double halfWidth, double z) {
    const auto first = std::uint32_t(mesh.positions.size()), row = std::uint32_t(side);
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x)
        mesh.positions.emplace_back(halfWidth * (2.0 * x / (side - 1) - 1), halfWidth * (2.0 * y / (side - 1) - 1), z);
    for (std::uint32_t y = 0; y + 1 < row; ++y)
      for (std::uint32_t x = 0; x + 1 < row; ++x) {
        const std::uint32_t at = first + y * row + x;
        mesh.triangles.emplace_back(at, at + 1, at + row);
        mesh.triangles.emplace_back(at + 1, at + row + 1, at + row);
      }
  };
  addGrid(kSide, 1, 0);
  addGrid(2, 0.3, 1);
  wall.model.surface.members.assign(mesh.positions.size(), 0b111);
  const double angles[]{0, kAside, -kAside};
  for (int i = 0; i < 3; ++i) {
    wall.model.cameras.push_back({"camera" + std::to_string(i), cameraAt(angles[i], kDistance), {}, {}});
    HtmImage& picture = wall.pictures.emplace_back(HtmImage{Image8(kSize, kSize, 3), Image8(kSize, kSize, 1)});
    for (std::size_t p = 0; p < std::size_t(kSize) * kSize; ++p)
      picture.photograph.values[3 * p + std::size_t(i)] = 255;
    std::ranges::fill(picture.visibility.values, std::uint8_t(255));
  }
  return wall;
}

// The image's colour at a point, which equals the cameras' shares.
glm::dvec3 sharesAt(const Image8& picture, const Camera& view, glm::dvec3 point) {
  const auto at = project(view.intrinsics, glm::conjugate(view.pose.rotation) * (point - view.pose.position));
  const auto pixel = picture.pixel(int(at->x), int(at->y));
  REQUIRE(pixel[3] == 255);
  return glm::dvec3(pixel[0], pixel[1], pixel[2]) / 255.0;
}

// Flat weights, with which all cameras would count if occlusion were ignored.
HtmSettings flat(HtmMethod method) {
  return {.gamma = 1, .method = method, .weightCut = 0};
}

}  // namespace

TEST_CASE("a camera does not colour surfaces that another part of the mesh hides", "[htm]") {
  const HtmStage stage(wall().model, wall().pictures);
  for (const HtmMethod method : kAll) {
    INFO("method " << int(method));
    const Camera view = cameraAt(0.6, kDistance);
    const Image8 picture = stage.render(view, flat(method));
    for (const glm::dvec3 behind : {glm::dvec3(-0.05, 0, 0), glm::dvec3(0, 0.15, 0), glm::dvec3(-0.1, -0.15, 0)}) {
      const glm::dvec3 shares = sharesAt(picture, view, behind);
      CHECK(shares.r == 0);
      CHECK(shares.g > 0.2);
      CHECK(shares.b > 0.2);
    }
    // Outside the screen's shadows, all cameras see the wall.
    const glm::dvec3 shares = sharesAt(picture, view, {0.05, 0.85, 0});
    CHECK(std::min({shares.r, shares.g, shares.b}) > 0.2);
  }
}

TEST_CASE("a camera does not colour surfaces that its mask excludes", "[htm]") {
  Wall masked = wall();
  const Camera& red = masked.model.cameras[0].camera;
  const int half = kSize / 2;
  for (int y = 0; y < half; ++y)  // the wall's upper half
    for (int x = 0; x < kSize; ++x) masked.pictures[0].visibility.pixel(x, y)[0] = 0;
  const glm::dvec3 above(0.05, 0.85, 0), below(0.05, -0.85, 0);
  REQUIRE(project(red.intrinsics, glm::conjugate(red.pose.rotation) * (above - red.pose.position))->y < half - 2);
  const HtmStage stage(masked.model, masked.pictures);
  for (HtmImage& picture : masked.pictures) std::ranges::fill(picture.visibility.values, std::uint8_t(0));
  const HtmStage blind(masked.model, masked.pictures);
  for (const HtmMethod method : kAll) {
    INFO("method " << int(method));
    const Image8 picture = stage.render(red, flat(method));
    CHECK(sharesAt(picture, red, above).r == 0);
    CHECK(sharesAt(picture, red, above).g > 0.3);
    CHECK(sharesAt(picture, red, below).r > 0.2);
    // If no camera sees the surface, all members count, hidden ones included.
    const Camera view = cameraAt(0.6, kDistance);
    const glm::dvec3 shares = sharesAt(blind.render(view, flat(method)), view, {-0.05, 0, 0});
    CHECK(std::min({shares.r, shares.g, shares.b}) > 0.2);
  }
}

}  // namespace ibr::test
