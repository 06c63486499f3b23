// SPDX-License-Identifier: Apache-2.0
// Panorama and pinhole projection, and non-finite input, of cameras.
#include "ibr/camera.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <random>
#include <tuple>
#include <utility>

#include "ibr/capture.h"
#include "ibr/error.h"
#include "support/extremes.h"

using namespace ibr;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kExtremes[] = {0.0,  -0.0,  5e-324, -5e-324, 1e-308,   1.0,       -1.0,       1e5, -1e5,
                                1e18, 1e154, -1e200, 1.7e308, -1.7e308, kInfinity, -kInfinity, kNan};
const Intrinsics kPanorama{CameraModel::equirectangular, 8192, 4096};

bool finite(glm::dvec3 v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace

TEST_CASE("pinhole cameras have fields of view from 0.001 to 179.9 degrees", "[N13]") {
  for (double degrees : {1e-3, 1.0, 60.0, 120.0, 170.0, 179.0, 179.9}) {
    const double fov = degrees * kPi / 180;
    const Intrinsics k = pinholeFromFov(1920, 1080, fov);
    const glm::dvec3 top = unproject(k, {960, 0}), bottom = unproject(k, {960, 1080});
    CHECK(std::acos(glm::dot(top, bottom)) == Approx(fov).epsilon(1e-4));
    CHECK(top.y > 0);
    for (glm::dvec2 corner : {glm::dvec2(0, 0), {1920, 0}, {0, 1080}, {1920, 1080}, {960, 540}}) {
      const glm::dvec3 ray = unproject(k, corner);
      CHECK(glm::length(ray) == Approx(1.0).epsilon(1e-15));
      CHECK(ray.z < 0);
      REQUIRE(project(k, ray));
      CHECK(glm::distance(*project(k, ray), corner) < 1e-8);
      CHECK(glm::distance(*project(k, ray * 1e-300), corner) < 1e-8);
    }
  }
  for (double wrong : {0.0, -1.0, kPi, 4.0, kNan, kInfinity, -kInfinity, 5e-324})
    CHECK_THROWS_AS(pinholeFromFov(640, 480, wrong), Error);
  CHECK_THROWS_AS(pinholeFromFov(0, 480, 1.0), Error);
  CHECK_THROWS_AS(pinholeFromFov(640, -1, 1.0), Error);
}

TEST_CASE("off-centre frusta are exact up to 89.9 degrees", "[N13]") {
  const double steepest = 89.9 * kPi / 180;
  double worst = 0;  // px
  for (double left : {-steepest, -1.0, -0.1, 1e-9, 0.3})
    for (double right : {0.31, 1.0, steepest})
      for (double down : {-steepest, -0.9, -1e-6, 0.2})
        for (double up : {0.21, 0.8, steepest}) {
          const Intrinsics k =
              pinholeFromTangents(2000, 1700, std::tan(left), std::tan(right), std::tan(up), std::tan(down));
          CHECK((k.model == CameraModel::pinhole && k.width == 2000 && k.height == 1700 && k.fx > 0 && k.fy > 0));
          // By definition, an edge's pixels look along the edge's angle, and the first row is up; checked both ways.
          for (const auto& [pixel, yaw, pitch] : {std::tuple(glm::dvec2(0, 0), left, up),
                                                  {{2000, 0}, right, up},
                                                  {{0, 1700}, left, down},
                                                  {{2000, 1700}, right, down}}) {
            const glm::dvec3 corner(std::tan(yaw), std::tan(pitch), -1);
            worst = std::max(worst, glm::distance(project(k, corner).value(), pixel));
            worst = std::max(worst, glm::distance(project(k, unproject(k, pixel)).value(), pixel));
            const glm::dvec3 ray = unproject(k, pixel);
            CHECK(std::atan2(ray.x, -ray.z) == Approx(yaw).margin(1e-12));
            CHECK(std::atan2(ray.y, -ray.z) == Approx(pitch).margin(1e-12));
          }
        }
  CHECK(worst < 1e-8);  // 0.01 px would suffice
}

TEST_CASE("the tangents of a centred pinhole camera give the same camera") {
  const double tangent = std::tan(0.4);
  const Intrinsics a = pinholeFromFov(640, 480, 0.8);
  const Intrinsics b = pinholeFromTangents(640, 480, -tangent * 4 / 3, tangent * 4 / 3, tangent, -tangent);
  CHECK(b.fx == Approx(a.fx).epsilon(1e-15));
  CHECK(b.fy == Approx(a.fy).epsilon(1e-15));
  CHECK(b.cx == Approx(a.cx).epsilon(1e-15));
  CHECK(b.cy == Approx(a.cy).epsilon(1e-15));
}

TEST_CASE("tangents without a valid frustum are refused", "[N13][N16]") {
  const auto refused = [](double left, double right, double up, double down) {
    CHECK_THROWS_AS(pinholeFromTangents(640, 480, left, right, up, down), Error);
  };
  const double beyond = std::tan(89.96 * kPi / 180);
  for (double wrong : {kNan, kInfinity, -kInfinity, beyond, -beyond, 1.7e308, -1.7e308}) {
    refused(wrong, 1, 1, -1);
    refused(-1, wrong, 1, -1);
    refused(-1, 1, wrong, -1);
    refused(-1, 1, 1, wrong);
  }
  refused(1, -1, 1, -1);
  refused(-1, 1, -1, 1);
  refused(0.5, 0.5, 1, -1);
  refused(-1, 1, -0.0, 0.0);
  refused(0, 5e-324, 1, -1);
  refused(-1, 1, 5e-324, 0);
  CHECK_THROWS_AS(pinholeFromTangents(0, 480, -1, 1, 1, -1), Error);
  CHECK_THROWS_AS(pinholeFromTangents(640, -1, -1, 1, 1, -1), Error);
}

TEST_CASE("the six axes are at their pixels of a panorama", "[N10][T19]") {
  // Axes: x right, y up; −z is forward, in the middle of the picture.
  const auto at = [](glm::dvec3 d) { return project(kPanorama, d).value(); };
  CHECK(at({0, 0, -1}) == glm::dvec2(4096, 2048));
  CHECK(at({1, 0, 0}) == glm::dvec2(6144, 2048));
  CHECK(at({-1, 0, 0}) == glm::dvec2(2048, 2048));
  CHECK(at({0, 1, 0}).y == 0.0);
  CHECK(at({0, -1, 0}).y == 4096.0);
  CHECK(at({1e-300, 0, 1}).x == Approx(8192));
  CHECK(at({-1e-300, 0, 1}).x == Approx(0).margin(1e-9));
}

TEST_CASE("panorama round trips are exact, also at the poles and the seam", "[N10]") {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const auto roundTrip = [](glm::dvec3 d) {
    const glm::dvec3 back = unproject(kPanorama, project(kPanorama, d).value());
    return glm::distance(back, glm::normalize(d));
  };
  for (double tiny : {0.0, -0.0, 1e-7, -1e-7, 1e-12})
    for (double other : {0.0, 1e-9, -1e-7}) {
      CHECK(roundTrip({tiny, 1, other}) < 1e-12);
      CHECK(roundTrip({other, -1, tiny}) < 1e-12);
      CHECK(roundTrip({tiny, other, 1}) < 1e-12);
    }
  for (int i = 0; i < 100000; ++i) REQUIRE(roundTrip({normal(random), normal(random), normal(random)}) < 1e-12);
  for (int i = 0; i < 1000; ++i) {
    const glm::dvec2 pixel(double(random() % 8192) + 0.5, double(random() % 4096) + 0.5);
    REQUIRE(glm::distance(project(kPanorama, unproject(kPanorama, pixel)).value(), pixel) < 1e-6);
  }
}

TEST_CASE("a pinhole camera sees nothing behind itself") {
  const Intrinsics k = pinholeFromFov(640, 480, 1.0);
  CHECK_FALSE(project(k, {0, 0, 1}));
  CHECK_FALSE(project(k, {1, 0, 0}));
  CHECK_FALSE(project(k, {0, 0, -0.0}));
  CHECK(project(k, {0, 0, -5e-324}) == glm::dvec2(320, 240));
}

TEST_CASE("a resized camera keeps its rays") {
  Intrinsics k{CameraModel::pinhole, 4000, 3000, 3100, 3090, 2010, 1480};
  const Intrinsics half = resized(k, 1000, 1500);
  for (glm::dvec2 pixel : {glm::dvec2(0, 0), {4000, 3000}, {17.5, 2000.25}})
    CHECK(glm::distance(unproject(k, pixel), unproject(half, pixel * glm::dvec2(0.25, 0.5))) < 1e-15);
  CHECK(resized(kPanorama, 100, 50) == Intrinsics{CameraModel::equirectangular, 100, 50});
  CHECK_THROWS_AS(resized(k, 0, 10), Error);
  CHECK_THROWS_AS(resized(Intrinsics{}, 10, 10), Error);
}

TEST_CASE("a view matrix inverts the model matrix of a pose, far from the world's origin too") {
  const Pose pose{{1e7, -2e6, 30}, glm::normalize(glm::dquat(0.8, 0.3, -0.4, 0.33))};
  for (const glm::dvec3 at : {glm::dvec3(0, 0, 0), {0, 0, -1}, {3, -4, 5}}) {
    const glm::dvec3 world = pose.position + pose.rotation * at;
    CHECK(glm::distance(glm::dvec3(worldFromCamera(pose) * glm::dvec4(at, 1)), world) < 1e-8);
    CHECK(glm::distance(glm::dvec3(cameraFromWorld(pose) * glm::dvec4(world, 1)), at) < 1e-8);
  }
}

TEST_CASE("the projection matrix has the pixels of project() and the depth of a DepthTarget") {
  const Intrinsics k = pinholeFromTangents(640, 360, -1.2, 0.7, 0.9, -0.4);
  for (const double far : {50.0, kInfinity})
    for (const bool reversed : {false, true})
      for (const glm::dvec3 at : {glm::dvec3(0, 0, -0.1), {0.3, -0.2, -0.7}, {-4, 5, -49}, {8, 1, -3}}) {
        const glm::dvec4 clip = clipFromCamera(k, 0.1, far, reversed) * glm::dvec4(at, 1);
        const glm::dvec2 pixel = (glm::dvec2(clip) / clip.w + 1.0) * 0.5 * glm::dvec2(640, 360);
        CHECK(glm::distance(pixel, *project(k, at)) < 1e-9);
        const double depth = std::isinf(far) ? 1 - 0.1 / -at.z : far / (far - 0.1) * (1 - 0.1 / -at.z);
        CHECK(clip.z / clip.w == Approx(reversed ? 1 - depth : depth).margin(1e-12));
      }
}

TEST_CASE("cameras and planes without a projection matrix are refused", "[N16]") {
  const Intrinsics k = pinholeFromFov(640, 480, 1.0);
  CHECK_NOTHROW(clipFromCamera(k, 1e-300, 1e300, true));
  for (const auto& [near, far] : {std::pair(0.0, 1.0),
                                  {-1.0, 1.0},
                                  {1.0, 1.0},
                                  {2.0, 1.0},
                                  {kNan, 1.0},
                                  {1.0, kNan},
                                  {kInfinity, kInfinity},
                                  {1.0, -kInfinity}})
    CHECK_THROWS_AS(clipFromCamera(k, near, far), Error);
  CHECK_THROWS_AS(clipFromCamera(kPanorama, 0.1), Error);
  for (double Intrinsics::*field : {&Intrinsics::fx, &Intrinsics::fy, &Intrinsics::cx, &Intrinsics::cy})
    for (const double wrong : {kNan, kInfinity, -kInfinity}) {
      Intrinsics other = k;
      other.*field = wrong;
      CHECK_THROWS_AS(clipFromCamera(other, 0.1), Error);
    }
  Intrinsics empty = k;
  empty.width = 0;
  CHECK_THROWS_AS(clipFromCamera(empty, 0.1), Error);
}

TEST_CASE("no camera function returns NaN for any input", "[N16][P4]") {
  std::vector<Intrinsics> cameras{kPanorama, pinholeFromFov(640, 480, 1.0)};
  for (double value : kExtremes)
    for (double Intrinsics::*field : {&Intrinsics::fx, &Intrinsics::fy, &Intrinsics::cx, &Intrinsics::cy}) {
      cameras.push_back(cameras[1]);
      cameras.back().*field = value;
    }
  std::size_t rays = 0, pixels = 0;
  for (const Intrinsics& k : cameras)
    for (double x : kExtremes)
      for (double y : kExtremes) {
        try {
          const glm::dvec3 ray = unproject(k, {x, y});
          REQUIRE(finite(ray));
          REQUIRE(std::abs(glm::length(ray) - 1) < 1e-12);
          REQUIRE((std::isfinite(x) && std::isfinite(y)));
          ++rays;
        } catch (const Error& e) {
          REQUIRE(e.code() == ErrorCode::invalidInput);
        }
        for (double z : kExtremes) {
          const auto pixel = project(k, {x, y, z});
          if (!pixel) continue;
          REQUIRE((std::isfinite(pixel->x) && std::isfinite(pixel->y)));
          ++pixels;
        }
      }
  CHECK(rays > 1000);
  CHECK(pixels > 1000);
  // Finite pixels and directions always have an answer if the camera is valid.
  for (double x : kExtremes)
    for (double y : kExtremes) {
      if (!std::isfinite(x) || !std::isfinite(y)) continue;
      CHECK_NOTHROW(unproject(cameras[0], {x, y}));
      CHECK_NOTHROW(unproject(cameras[1], {x, y}));
      if (x != 0 || y != 0) CHECK(project(kPanorama, {x, y, 0}).has_value());
    }
}

TEST_CASE("rays of a panorama pass through pixel centres", "[N10][T20]") {
  const Intrinsics small{CameraModel::equirectangular, 8, 4};
  for (int x = 0; x < 8; ++x)
    for (int y = 0; y < 4; ++y) {
      const glm::dvec3 ray = unproject(small, {x + 0.5, y + 0.5});
      CHECK(std::atan2(ray.x, -ray.z) == Approx((x + 0.5) / 8 * 2 * kPi - kPi));
      CHECK(std::asin(ray.y) == Approx(kPi / 2 - (y + 0.5) / 4 * kPi));
      // The mirrored pixel has the mirrored ray: there is no half-pixel offset.
      const glm::dvec3 mirrored = unproject(small, {7 - x + 0.5, 3 - y + 0.5});
      CHECK(glm::distance(mirrored, glm::dvec3(-ray.x, -ray.y, ray.z)) < 1e-15);
    }
}

TEST_CASE("the exposure of a photograph is positive or unknown", "[N16]") {
  for (const double value : test::kExtremes)
    for (double CaptureMetadata::*field :
         {&CaptureMetadata::exposureTime, &CaptureMetadata::fNumber, &CaptureMetadata::iso}) {
      CaptureMetadata facts{0.01, 8, 100, 0, 0, "", "", ""};
      facts.*field = value;
      INFO(value);
      const auto exposure = relativeExposure(facts);
      CHECK((!exposure || (*exposure > 0 && std::isfinite(*exposure))));
    }
}
