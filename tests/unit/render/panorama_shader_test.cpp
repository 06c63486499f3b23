// SPDX-License-Identifier: Apache-2.0
// Panorama coordinates in the shader's single precision, against double precision.
#include "shared/panorama.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>

#include "ibr/camera.h"
#include "render/plan/cell_distance.h"

using namespace ibr;

namespace {

constexpr double kPi = std::numbers::pi;
const Intrinsics kPanorama{CameraModel::equirectangular, 8192, 4096};

// Distance on the sphere between a direction and the shader's result, px of the equator.
double error(glm::vec3 direction) {
  const shader::vec2 at = shader::panoramaCoordinate(direction);
  REQUIRE(at.x >= 0.0f);
  REQUIRE(at.x <= 1.0f);
  REQUIRE(at.y >= 0.0f);
  REQUIRE(at.y <= 1.0f);
  const glm::dvec3 back = unproject(kPanorama, glm::dvec2(double(at.x) * 8192, double(at.y) * 4096));
  return glm::distance(back, glm::normalize(glm::dvec3(direction))) * 8192 / (2 * kPi);
}

// Ray of a pinhole's pixel and differences to its neighbours; the camera looks along `ray`, rolled by `roll`.
struct Pixel {
  glm::vec3 ray, dx, dy;
};
Pixel pixelAt(glm::dvec3 ray, double size, double roll = 0) {
  ray = glm::normalize(ray);
  const glm::dvec3 side =
      glm::normalize(glm::cross(ray, std::abs(ray.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0)));
  const glm::dvec3 up = glm::cross(side, ray);
  const glm::dvec3 x = std::cos(roll) * side + std::sin(roll) * up, y = std::cos(roll) * up - std::sin(roll) * side;
  return {glm::vec3(ray), glm::vec3(glm::normalize(ray + size * x) - ray),
          glm::vec3(glm::normalize(ray + size * y) - ray)};
}

}  // namespace

TEST_CASE("angles of the shader are exact to 3e-7 in every quadrant", "[N10][T21]") {
  CHECK(shader::angleOf(0.0f, 0.0f) == 0.0f);
  CHECK(shader::angleOf(0.0f, 1.0f) == 0.0f);
  CHECK(shader::angleOf(1.0f, 0.0f) == float(kPi / 2));
  CHECK(shader::angleOf(-1.0f, 0.0f) == -float(kPi / 2));
  CHECK(shader::angleOf(0.0f, -1.0f) == Approx(kPi).margin(1e-7));
  double worst = 0;
  for (int i = 0; i < 200000; ++i) {
    const double angle = -kPi + 2 * kPi * (i + 0.5) / 200000, length = std::exp2(i % 61 - 30);
    const float y = float(length * std::sin(angle)), x = float(length * std::cos(angle));
    worst = std::max(worst, std::abs(double(shader::angleOf(y, x)) - std::atan2(double(y), double(x))));
  }
  CHECK(worst < 3e-7);
  for (const float tiny : {1e-7f, -1e-7f, 1e-30f, 1e-38f, -1e-45f}) {
    CHECK(double(shader::angleOf(tiny, 1.0f)) == Approx(double(tiny)));
    CHECK(double(shader::angleOf(1.0f, tiny)) == Approx(kPi / 2));
  }
}

TEST_CASE("directions map to pixels within 1e-3 px of 8192, poles and antimeridian included", "[N10][T21]") {
  for (const float tiny : {0.0f, -0.0f, 1e-7f, -1e-7f})
    for (const float other : {0.0f, -0.0f, 1e-7f, -1e-7f})
      for (const float pole : {1.0f, -1.0f}) {
        CHECK(error({tiny, pole, other}) < 1e-3);
        CHECK(error({tiny, other, pole}) < 1e-3);
        CHECK(error({pole, tiny, other}) < 1e-3);
      }
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  double worst = 0;
  for (int i = 0; i < 100000; ++i) {
    const glm::vec3 direction(glm::dvec3(normal(random), normal(random), normal(random)) * std::exp2(i % 41 - 20));
    worst = std::max(worst, error(direction));
  }
  CHECK(worst < 1.2e-3);  // 3e-7 rad of longitude, half a ulp of u, and the same in latitude
}

TEST_CASE("the six axes map to the pixels of the camera convention", "[N10][T19]") {
  const auto at = [](float x, float y, float z) { return shader::panoramaCoordinate({x, y, z}); };
  CHECK(at(0, 0, -1) == shader::vec2(0.5f, 0.5f));
  CHECK(at(1, 0, 0) == shader::vec2(0.75f, 0.5f));
  CHECK(at(-1, 0, 0) == shader::vec2(0.25f, 0.5f));
  CHECK(at(0, 1, 0).y == 0.0f);
  CHECK(at(0, -1, 0).y == 1.0f);
  CHECK(at(1e-6f, 0, 1).x == Approx(1).margin(1e-6));
  CHECK(at(-1e-6f, 0, 1).x == Approx(0).margin(1e-6));
}

TEST_CASE("a pixel's level of detail is the same for every direction and roll") {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  const double size = 0.004;  // rad
  const double texels = size * 8192 / (2 * kPi);
  std::vector<glm::dvec3> rays = {{0, 1, 0}, {0, -1, 0},   {1e-7, 1, 0}, {1e-4, -1, 1e-5},
                                  {0, 0, 1}, {1e-7, 0, 1}, {-1e-7, 0, 1}};
  for (int i = 0; i < 10000; ++i) rays.push_back({normal(random), normal(random), normal(random)});
  for (const glm::dvec3& ray : rays) {
    const Pixel pixel = pixelAt(ray, size, normal(random));
    const auto footprint = shader::panoramaFootprint(pixel.ray, pixel.dx, pixel.dy, {8192, 4096});
    REQUIRE(double(footprint.texels) == Approx(texels).epsilon(2e-3));
  }
}

TEST_CASE("towards a pole a pixel takes more taps, without gaps or steps") {
  const double size = 0.004, texels = size * 8192 / (2 * kPi);  // 5.2
  float before = 0;
  for (int i = 0; i <= 9000; ++i) {
    const double latitude = i * kPi / 2 / 9000;
    const Pixel pixel = pixelAt({0, std::sin(latitude), -std::cos(latitude)}, size);
    const auto footprint = shader::panoramaFootprint(pixel.ray, pixel.dx, pixel.dy, {8192, 4096});
    REQUIRE(footprint.reach >= 0.0f);
    REQUIRE(footprint.reach <= shader::kMaxPanoramaReach);
    if (latitude < 0.8) REQUIRE(footprint.reach == 0.0f);
    REQUIRE(std::abs(footprint.reach - before) < 0.05f);
    before = footprint.reach;
    const double width = texels / std::max(std::cos(latitude), 1e-6);
    const double covered = (1.5 + 2 * double(footprint.reach)) * double(footprint.spacing) * 8192;
    if (footprint.reach == 0.0f)
      REQUIRE(covered >= width * 0.99);
    else if (footprint.reach < shader::kMaxPanoramaReach)
      REQUIRE(covered == Approx(width).epsilon(0.01));
    else
      REQUIRE(covered <= 8192 * 1.11);  // once around the pole
  }
  CHECK(before == shader::kMaxPanoramaReach);
  // If texels are larger than pixels, one tap interpolates.
  const Pixel fine = pixelAt({0, 0.5, -1}, 1e-4);
  CHECK(shader::panoramaFootprint(fine.ray, fine.dx, fine.dy, {8192, 4096}).reach == 0.0f);
}

TEST_CASE("cells of panoramas have no rotational distance, and mixed cells less than pinhole cells") {
  Scene scene;
  for (const double x : {0.0, 1.0})
    scene.nodes.push_back({"", {{CameraModel::equirectangular, 64, 32}, {{x, 0, 0}, {1, 0, 0, 0}}}, "", ""});
  Cell cell;
  cell.members = {0, 1};
  const glm::dquat right = glm::angleAxis(-1.0, glm::dvec3(0, 1, 0));
  const Pose view{{0.25, 0, 0}, right};
  CHECK(cellDistance(cellPoses(scene, cell), 1, view).rotation == 0);
  scene.nodes[0].camera.intrinsics = pinholeFromFov(64, 48, 1);
  const double half = cellDistance(cellPoses(scene, cell), 1, view).rotation;
  scene.nodes[1].camera.intrinsics = pinholeFromFov(64, 48, 1);
  CHECK(cellDistance(cellPoses(scene, cell), 1, view).rotation == Approx(1));
  CHECK(half > 0.6);
  CHECK(half < 0.9);
}

TEST_CASE("near a pole angles are more accurate than with the arc cosine", "[N10][T21]") {
  const double pixels = 8192 / (2 * kPi);  // px of the equator per radian
  double worst = 0, worstOfPaper = 0;
  for (double fromPole = 1e-8; fromPole < 1e-2; fromPole *= 1.07)
    for (const double pole : {1.0, -1.0}) {
      const glm::dvec3 exact(std::sin(fromPole) * 0.6, pole * std::cos(fromPole), std::sin(fromPole) * 0.8);
      const glm::vec3 direction(exact);
      const double true_ = std::atan2(std::hypot(double(direction.x), double(direction.z)), double(direction.y));
      worst = std::max(worst, std::abs(double(shader::panoramaCoordinate(direction).y) * kPi - true_) * pixels);
      worstOfPaper = std::max(worstOfPaper, std::abs(double(std::acos(direction.y)) - true_) * pixels);
    }
  CHECK(worst < 1e-3);
  CHECK(worstOfPaper > 0.2);
}
