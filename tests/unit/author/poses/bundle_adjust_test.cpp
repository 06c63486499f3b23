// SPDX-License-Identifier: Apache-2.0
#include "author/poses/bundle_adjust.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "author/poses/bundle_residual.h"
#include "ibr/author/poses.h"
#include "support/pose_noise.h"
#include "support/posed_rig.h"

using namespace ibr;
using namespace ibr::test;

namespace {

std::vector<Camera> ring(std::size_t count) {
  std::vector<Camera> cameras;
  for (std::size_t i = 0; i < count; ++i) {
    const double a = 0.15 * double(i);
    cameras.push_back(lookingAlong({-10 * std::cos(a), -10 * std::sin(a), 0.3 * double(i % 3)},
                                   {std::cos(a), std::sin(a), 0.05}, 1200, 900, 0.8));
  }
  return cameras;
}

std::vector<glm::dvec3> cloud(std::size_t count, unsigned seed) {
  PoseNoise random(seed);
  std::vector<glm::dvec3> points;
  for (std::size_t i = 0; i < count; ++i) points.push_back(random.vector(2.5));
  return points;
}

std::vector<BundleCamera> bundled(const std::vector<Camera>& cameras) {
  std::vector<BundleCamera> list;
  for (const Camera& camera : cameras) list.push_back({camera});
  return list;
}

std::vector<BundlePoint> seenBy(const std::vector<Camera>& cameras, const std::vector<glm::dvec4>& points) {
  std::vector<BundlePoint> list;
  for (const glm::dvec4& point : points) {
    BundlePoint track{point, {}};
    for (std::uint32_t i = 0; i < cameras.size(); ++i)
      if (const auto pixel = seenAt(cameras[i], point)) track.seen.push_back({i, *pixel});
    list.push_back(std::move(track));
  }
  return list;
}

std::vector<glm::dvec4> finite(const std::vector<glm::dvec3>& points) {
  std::vector<glm::dvec4> list;
  for (const glm::dvec3& p : points) list.emplace_back(p, 1);
  return list;
}

double largestError(const std::vector<Camera>& cameras, const std::vector<BundlePoint>& points, const Bundle& bundle) {
  double worst = 0;
  for (std::size_t p = 0; p < points.size(); ++p)
    for (const auto& [camera, pixel] : points[p].seen) {
      const auto at = seenAt(cameras[camera], bundle.points[p]);
      worst = std::max(worst, at ? glm::distance(*at, pixel) : 1e9);
    }
  return worst;
}

}  // namespace

TEST_CASE("derivatives of a residual match finite differences for near and infinite points and any rotation") {
  const Camera camera = ring(1)[0];
  constexpr std::size_t kPose = kPoseUnknowns, kLens = kLensUnknowns;
  for (const double w : {0.0, 1e-7, 0.1, 0.4})
    for (const double turn : {0.0, 1e-6, 0.02, 0.3}) {
      const glm::dvec3 towards(1, 0.1, -0.2);
      const AnchoredPoint point = anchorPoint({towards + w * glm::dvec3(-9.5, 0.3, 0.1), w}, {-9.5, 0.3, 0.1});
      std::array<double, 12> at{turn, -0.5 * turn, 0.7 * turn, 0.1, -0.2, 0.3, 0.02, 3, -2, 0.01, -0.02, w};
      const auto residual = [&](bool derivatives) {
        return bundleResidual(camera, point, {500, 400}, at.data(), at.data() + kPose, at.data() + kPose + kLens,
                              derivatives);
      };
      const auto found = residual(true);
      REQUIRE(found);
      for (std::size_t u = 0; u < at.size(); ++u) {
        const double before = at[u], step = u == 7 || u == 8 ? 1e-3 : 1e-6;
        at[u] = before + step;
        const glm::dvec2 up = residual(false)->off;
        at[u] = before - step;
        const glm::dvec2 down = residual(false)->off;
        at[u] = before;
        for (std::size_t r = 0; r < 2; ++r) {
          const double by = u < kPose           ? found->poseJacobian[r][u]
                            : u < kPose + kLens ? found->lensJacobian[r][u - kPose]
                                                : found->pointJacobian[r][u - kPose - kLens];
          INFO("w " << w << ", turn " << turn << ", unknown " << u << ", row " << r);
          CHECK(by == Approx((up - down)[int(r)] / (2 * step)).epsilon(1e-6).margin(1e-5));
        }
      }
    }
}

TEST_CASE("exact poses stay, and inaccurate poses converge to the observations") {
  const std::vector<Camera> exact = ring(6);
  const std::vector<BundlePoint> points = seenBy(exact, finite(cloud(200, 1)));
  const Bundle same = adjustBundle(bundled(exact), points);
  for (std::size_t i = 0; i < exact.size(); ++i) {
    CHECK(glm::distance(same.cameras[i].pose.position, exact[i].pose.position) < 1e-9);
    CHECK(angleBetween(same.cameras[i].pose.rotation, exact[i].pose.rotation) < 1e-9);
  }
  const std::vector<Camera> wrong = PoseNoise(4).on(exact, 0.003, 0.01);
  BundleOptions options;
  options.minDecrease = 1e-12;
  options.radians = options.shift = 1;
  const Bundle fits = adjustBundle(bundled(wrong), points, options);
  CHECK(largestError(fits.cameras, points, fits) < 0.02);
  const std::vector<BundlePoint> none;
  CHECK(adjustBundle(bundled(wrong), none).cameras[2].pose.position == wrong[2].pose.position);
}

TEST_CASE("fixed cameras and intrinsics without a prior stay unchanged; shared intrinsics change together") {
  std::vector<Camera> exact = ring(6), wrong = PoseNoise(4).on(exact, 0.002, 0);
  const std::vector<BundlePoint> points = seenBy(exact, finite(cloud(300, 2)));
  for (Camera& camera : wrong) camera.intrinsics.fx *= 1.02, camera.intrinsics.fy *= 1.02;
  std::vector<BundleCamera> cameras = bundled(wrong);
  cameras[1].fixed = true;
  cameras[5].intrinsics = 1;
  const Bundle stays = adjustBundle(cameras, points);
  CHECK(stays.cameras[1].pose.position == wrong[1].pose.position);
  for (std::size_t i = 0; i < 6; ++i) CHECK(stays.cameras[i].intrinsics == wrong[i].intrinsics);
  BundleOptions options;
  options.focal = 0.05;
  options.centrePx = 1;
  options.minDecrease = 1e-10;
  options.rounds = 200;
  const Bundle moved = adjustBundle(cameras, points, options);
  CHECK(moved.cameras[1].pose.position == wrong[1].pose.position);
  for (std::size_t i = 1; i < 5; ++i) CHECK(moved.cameras[i].intrinsics == moved.cameras[0].intrinsics);
  CHECK(moved.cameras[0].intrinsics.fx == Approx(exact[0].intrinsics.fx).epsilon(0.002));
  CHECK(moved.cameras[5].intrinsics.fx != moved.cameras[0].intrinsics.fx);
}

TEST_CASE("points at infinity determine rotations and leave positions unchanged") {
  const std::vector<Camera> exact = ring(5), wrong = PoseNoise(9).on(exact, 0.003, 0);
  std::vector<glm::dvec4> sky;
  PoseNoise random(3);
  for (int i = 0; i < 200; ++i) sky.emplace_back(glm::dvec3(1, 0.3, 0) + random.vector(0.25), 0.0);
  std::vector<BundleCamera> cameras = bundled(wrong);
  cameras[0] = {exact[0], 0, true};
  const Bundle bundle = adjustBundle(cameras, seenBy(exact, sky));
  for (std::size_t i = 0; i < 5; ++i) {
    CHECK(angleBetween(bundle.cameras[i].pose.rotation, exact[i].pose.rotation) < 1e-4);
    CHECK(glm::distance(bundle.cameras[i].pose.position, exact[i].pose.position) < 1e-3);
  }
}

TEST_CASE("outliers, points behind cameras and points of a single camera do not disturb the adjustment") {
  const std::vector<Camera> exact = ring(6), wrong = PoseNoise(4).on(exact, 0.002, 0.01);
  std::vector<BundlePoint> points = seenBy(exact, finite(cloud(400, 1)));
  for (std::size_t p = 0; p < points.size(); p += 10) points[p].seen[1].pixel += glm::dvec2(40, -25);
  const std::size_t behind = points.size();
  points.push_back({{100, 0, 0, 1}, {{0, {600, 450}}, {1, {600, 450}}}});
  points.back().position.x = -100;
  points.push_back({{0, 0, 0, 1}, {{2, {600, 450}}}});
  const Bundle bundle = adjustBundle(bundled(wrong), points);
  CHECK(glm::distance(glm::dvec3(bundle.points[behind]) / bundle.points[behind].w, {-100, 0, 0}) < 1e-6);
  std::vector<double> errors;
  for (std::size_t p = 1; p < 400; p += 10)
    for (const auto& [camera, pixel] : points[p].seen)
      errors.push_back(glm::distance(*seenAt(bundle.cameras[camera], bundle.points[p]), pixel));
  CHECK(*std::ranges::max_element(errors) < 0.3);
}

TEST_CASE("the same input gives the same bits") {
  const std::vector<Camera> exact = ring(6), wrong = PoseNoise(4).on(exact, 0.002, 0.01);
  const std::vector<BundlePoint> points = seenBy(exact, finite(cloud(200, 1)));
  const Bundle a = adjustBundle(bundled(wrong), points), b = adjustBundle(bundled(wrong), points);
  for (std::size_t i = 0; i < exact.size(); ++i) {
    CHECK((a.cameras[i].pose.position == b.cameras[i].pose.position));
    CHECK((a.cameras[i].pose.rotation == b.cameras[i].pose.rotation));
  }
  CHECK((a.points == b.points));
}
