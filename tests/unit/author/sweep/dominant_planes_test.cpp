// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "author/geometry/mean_frame.h"
#include "author/match/match.h"
#include "author/sweep/dominant_planes.h"
#include "author/sweep/plane_sweep.h"
#include "author/sweep/sgm.h"
#include "lab/generate/synthetic.h"
#include "support/posed_rig.h"

using namespace ibr;
using namespace ibr::test;

namespace {

constexpr double kGround = -0.8;  // z of the ground plane

const std::vector<Camera> kCameras = {lookingAlong({0, 0, 0}, {0, 1, 0}, 200, 150, 1.4),
                                      lookingAlong({0.7, 0, 0.05}, {0, 1, 0}, 200, 150, 1.4),
                                      lookingAlong({0.3, 0.1, 0.4}, {0, 1, 0}, 200, 150, 1.4)};

// kCameras at 1600 × 1200 px, so that few random points lie on one plane by chance.
std::vector<Camera> largeCameras() {
  std::vector<Camera> cameras = kCameras;
  for (Camera& camera : cameras) camera.intrinsics = resized(camera.intrinsics, 1600, 1200);
  return cameras;
}

std::vector<glm::dvec3> pointsOnGround(int count) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> across(-1.5, 1.5), along(1.2, 8);
  std::vector<glm::dvec3> points;
  for (int i = 0; i < count; ++i) points.emplace_back(across(random), along(random), kGround);
  return points;
}
// Random points in front of the cameras, on no common plane.
std::vector<glm::dvec3> scatteredPoints(int count) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> side(-1, 1), along(2, 8);
  std::vector<glm::dvec3> points;
  for (int i = 0; i < count; ++i) points.emplace_back(side(random), along(random), side(random));
  return points;
}
std::vector<glm::dvec3> mixedPoints() {
  std::vector<glm::dvec3> points = pointsOnGround(80);
  for (const glm::dvec3& point : scatteredPoints(80)) points.push_back(point);
  return points;
}

struct Motion {
  glm::dquat turn = glm::normalize(glm::dquat(0.8, 0.3, -0.4, 0.2));
  glm::dvec3 shift{30, -20, 7};
  glm::dvec3 operator()(glm::dvec3 p) const { return turn * p + shift; }
  Camera operator()(Camera camera) const {
    camera.pose = {(*this)(camera.pose.position), glm::normalize(turn * camera.pose.rotation)};
    return camera;
  }
  template <class T>
  std::vector<T> operator()(std::vector<T> all) const {
    for (T& one : all) one = (*this)(one);
    return all;
  }
};

const TexturedPlane kGroundPlane{{0, 10, kGround}, {1, 0, 0}, {0, 1, 0}, 40, 20, 3, 0.2};
const TexturedPlane kWallPlane{{0, 5, 0}, {1, 0, 0}, {0, 0, 1}, 20, 20, 1, 0.1};

// Returns photographs of the plane by kCameras.
std::vector<MatchView> viewsOf(const TexturedPlane& plane) {
  SyntheticOptions options;
  options.cameras = kCameras;
  options.planes = {plane};
  const SyntheticScene scene = makeScene(options);
  std::vector<MatchView> views;
  for (std::size_t i = 0; i < kCameras.size(); ++i) views.push_back({kCameras[i], scene.photographs[i]});
  return views;
}

std::vector<SweepView> inGreen(std::span<const MatchView> views) {
  std::vector<SweepView> result;
  for (const MatchView& view : views) {
    result.push_back({view.camera, ImageF(view.picture.width, view.picture.height, 1)});
    for (std::size_t p = 0; p < result.back().grey.values.size(); ++p)
      result.back().grey.values[p] = view.picture.values[3 * p + 1];
  }
  return result;
}

// Share of the ground area seen by all members in which the level is within half a step of the plane.
double shareRight(const ImageF& level, const SweepLevels& levels, glm::dvec3 plane) {
  std::size_t right = 0, all = 0;
  for (int y = level.height * 3 / 5; y < level.height * 3 / 4; ++y)
    for (int x = level.width * 2 / 5; x < level.width * 3 / 5; ++x, ++all)
      right += std::abs(levels.at(double(level.pixel(x, y)[0])) - glm::dot(plane, glm::dvec3(x + 0.5, y + 0.5, 1.0))) <
               0.5 * levels.step;
  return double(right) / double(all);
}

}  // namespace

TEST_CASE("a dominant plane is found among other points, independent of the world's frame") {
  const std::vector<Camera> cameras = largeCameras();
  const Camera frame = meanFrame(cameras);
  const std::vector<glm::dvec3> points = mixedPoints(), planes = dominantPlanes(frame, cameras, points);
  REQUIRE(planes.size() == 1);
  for (const glm::dvec3& point : pointsOnGround(20)) {
    const auto pixel = project(frame.intrinsics, glm::inverse(frame.pose.rotation) * (point - frame.pose.position));
    REQUIRE(pixel.has_value());
    CHECK(glm::dot(planes[0], glm::dvec3(*pixel, 1.0)) == Approx(inverseDepth(frame, point)).epsilon(0.01));
  }
  CHECK(dominantPlanes(frame, cameras, points) == planes);
  const Motion move;
  const std::vector<Camera> moved = move(cameras);
  const std::vector<glm::dvec3> same = dominantPlanes(meanFrame(moved), moved, move(points));
  REQUIRE(same.size() == 1);
  CHECK(glm::distance(same[0], planes[0]) < 1e-6 * glm::length(planes[0]));
}

TEST_CASE("points on no plane, few points, and members without parallax have no dominant plane") {
  const std::vector<Camera> cameras = largeCameras();
  const Camera frame = meanFrame(cameras);
  CHECK(dominantPlanes(frame, cameras, scatteredPoints(300)).empty());
  CHECK(dominantPlanes(frame, cameras, pointsOnGround(8)).empty());
  CHECK(dominantPlanes(frame, cameras, {}).empty());
  CHECK(dominantPlanes(cameras[0], std::vector<Camera>(2, cameras[0]), pointsOnGround(80)).empty());
}

TEST_CASE("ground at grazing angles is matched better along its plane") {
  const std::vector<SweepView> views = inGreen(viewsOf(kGroundPlane));
  const Camera frame = meanFrame(kCameras);
  std::vector<double> depths;
  for (const glm::dvec3& point : pointsOnGround(80)) depths.push_back(inverseDepth(frame, point));
  const SweepLevels levels = sweepLevels(frame, kCameras, depths);
  const std::vector<glm::dvec3> planes = dominantPlanes(frame, kCameras, pointsOnGround(80));
  REQUIRE(planes.size() == 1);
  const double with = shareRight(semiGlobalMatch(planeSweep(frame, views, levels, planes)).level, levels, planes[0]);
  const double without = shareRight(semiGlobalMatch(planeSweep(frame, views, levels)).level, levels, planes[0]);
  INFO(without << " → " << with);
  CHECK(with > 0.9);
  CHECK(with > without + 0.1);

  const std::vector<glm::dvec3> facing{{0.05 * levels.step, 0, 0.3}};
  CHECK(planeSweep(frame, views, levels, facing).cost == planeSweep(frame, views, levels).cost);
}

TEST_CASE("a plane that is not in the scene does not attract matches") {
  const std::vector<SweepView> views = inGreen(viewsOf(kWallPlane));
  const Camera frame = meanFrame(kCameras);
  const SweepLevels levels = sweepLevels(frame, kCameras, {0.1, 0.2, 0.8});
  const std::vector<glm::dvec3> planes = dominantPlanes(frame, kCameras, pointsOnGround(80));
  REQUIRE(planes.size() == 1);
  const glm::dvec3 wall(0, 0, 1 / (5 - frame.pose.position.y));
  const double with = shareRight(semiGlobalMatch(planeSweep(frame, views, levels, planes)).level, levels, wall);
  const double without = shareRight(semiGlobalMatch(planeSweep(frame, views, levels)).level, levels, wall);
  CHECK(with > 0.95);
  CHECK(with > without - 0.005);
}

TEST_CASE("matches do not depend on the scene's position in the world") {
  const std::vector<MatchView> views = viewsOf(kGroundPlane);
  const Motion move;
  std::vector<MatchView> moved = views;
  for (MatchView& view : moved) view.camera = move(view.camera);
  const DenseMatch here = matchViews(views, mixedPoints()), there = matchViews(moved, move(mixedPoints()));
  REQUIRE(here.inverseDepth.values.size() == there.inverseDepth.values.size());
  CHECK(here.good == there.good);
  std::size_t other = 0, otherMatched = 0;
  for (std::size_t p = 0; p < here.inverseDepth.values.size(); ++p) {
    const bool differs =
        std::abs(here.inverseDepth.values[p] - there.inverseDepth.values[p]) > 0.1f * here.inverseDepthStep;
    other += differs;
    otherMatched += differs && here.good.values[p];
  }
  CHECK(otherMatched == 0);
  // Pixels that not all members see may differ: rounding reorders almost equal costs.
  CHECK(double(other) < 0.005 * double(here.inverseDepth.values.size()));
}
