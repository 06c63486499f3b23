// SPDX-License-Identifier: Apache-2.0
#include "author/depth/depth_sources.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "author/geometry/posed_model.h"
#include "support/posed_rig.h"

using namespace ibr;
using namespace ibr::test;

namespace {

constexpr double kDistance = 10;

// Photographs on the x axis that look along y at points of a wall; each observes the points inside its picture.
struct Capture {
  PosedModel model;
  std::vector<Camera> cameras;

  void photograph(double x, glm::dvec3 forward = {0, 1, 0}) {
    const Camera camera = lookingAlong({x, 0, 0}, forward, 320, 240, 1.2);
    model.images.push_back({std::to_string(cameras.size()) + ".jpg", camera});
    cameras.push_back(camera);
  }
  // Each track beyond x = 3 is repeated `crowd` times.
  std::vector<std::uint32_t> sourcesOf(std::uint32_t photograph, int crowd = 1) {
    model.tracks.clear();
    for (int row = -6; row <= 6; ++row)
      for (int column = -30; column <= 30; ++column) {
        Track track{{0.5 * column, kDistance, 0.5 * row}, {}};
        for (std::uint32_t i = 0; i < cameras.size(); ++i) {
          const Camera& camera = cameras[i];
          const auto at = project(camera.intrinsics,
                                  glm::conjugate(camera.pose.rotation) * (track.position - camera.pose.position));
          if (at && at->x > 0 && at->y > 0 && at->x < 320 && at->y < 240) track.observations.push_back({i, *at});
        }
        if (!track.observations.empty()) model.tracks.insert(model.tracks.end(), column > 6 ? crowd : 1, track);
      }
    return depthSources(model, depthViews(cameras), tracksOfImages(model), photograph);
  }
};

bool holds(const std::vector<std::uint32_t>& list, std::uint32_t one) {
  return std::ranges::find(list, one) != list.end();
}

}  // namespace

TEST_CASE("the first source is about six degrees away, and photographs of the same position are no sources") {
  Capture capture;
  for (const double x : {0.0, 0.0, 0.05, 1.05, 6.0}) capture.photograph(x);  // 1.05: 6° at kDistance
  const auto sources = capture.sourcesOf(0);
  REQUIRE_FALSE(sources.empty());
  CHECK(sources[0] == 3);
  CHECK_FALSE(holds(sources, 0));
  CHECK((sources.size() < 2 || sources.back() != 3));
}

TEST_CASE("a photograph that looks in another direction is a source only if it sees the same points") {
  Capture capture;
  capture.photograph(0);
  capture.photograph(1, {0.3, 1, 0});
  capture.photograph(1, {0, -1, 0});
  const auto sources = capture.sourcesOf(0);
  CHECK(sources == std::vector<std::uint32_t>{1});
}

TEST_CASE("both sides of an image have sources, up to the maximum number") {
  Capture capture;
  capture.photograph(0);
  for (int i = 0; i < 8; ++i) capture.photograph(0.9 + 0.01 * i, {0.9, 1, 0});  // all see the right side
  capture.photograph(-1, {-0.9, 1, 0});
  const auto sources = capture.sourcesOf(0);
  CHECK(sources.size() <= kNearSources + kWideSources);
  CHECK(std::ranges::find(sources.begin(), sources.begin() + 2, 9u) != sources.begin() + 2);
}

TEST_CASE("regions count by their share of the image, however many tracks they have") {
  Capture capture;
  capture.photograph(0);
  capture.photograph(-1.05, {-0.35, 1, 0});  // sees most of the wall that photograph 0 sees
  capture.photograph(1.05, {1.1, 1, 0});     // sees the right side only
  REQUIRE(capture.sourcesOf(0).size() == 2);
  for (const int crowd : {1, 50}) CHECK(capture.sourcesOf(0, crowd)[0] == 1);
}

TEST_CASE("a single photograph, and one without tracks, has no sources") {
  Capture capture;
  capture.photograph(0);
  CHECK(capture.sourcesOf(0).empty());
  capture.photograph(1);
  capture.model.tracks.clear();
  CHECK(depthSources(capture.model, depthViews(capture.cameras), tracksOfImages(capture.model), 0).empty());
}

TEST_CASE("moving and rotating the world does not change the sources") {
  Capture capture;
  for (const double x : {0.0, 0.4, 1.1, 1.9, 3.0, -0.8}) capture.photograph(x);
  const auto before = capture.sourcesOf(0);
  const glm::dquat turn = glm::normalize(glm::dquat(0.8, 0.3, -0.4, 0.2));
  const glm::dvec3 shift{1e4, -200, 70};
  for (Camera& camera : capture.cameras)
    camera.pose = {turn * camera.pose.position + shift, glm::normalize(turn * camera.pose.rotation)};
  for (Track& track : capture.model.tracks) track.position = turn * track.position + shift;
  CHECK(depthSources(capture.model, depthViews(capture.cameras), tracksOfImages(capture.model), 0) == before);
}

TEST_CASE("a panorama's faces are views with its tracks, and no face is a source of another") {
  Capture capture;
  for (const double x : {0.0, 1.05}) capture.photograph(x);
  std::vector<Camera> cameras = capture.cameras;
  for (const double x : {2.0, 3.0})
    cameras.push_back({{CameraModel::equirectangular, 256, 128}, {{x, 0, 0}, {1, 0, 0, 0}}});
  const std::vector<DepthView> views = depthViews(cameras);
  REQUIRE(views.size() == 2 + 2 * 6);
  for (std::size_t v = 0; v < views.size(); ++v) {
    CHECK(views[v].node == (v < 2 ? v : 2 + (v - 2) / 6));
    CHECK(views[v].isFace == (v >= 2));
    CHECK(views[v].camera.intrinsics.model == CameraModel::pinhole);
    CHECK(views[v].camera.pose.position == cameras[views[v].node].pose.position);
  }
  // Points in front of the photographs, which look along y; the panoramas' up axis is y.
  PosedModel model;
  for (const Camera& camera : cameras) model.images.push_back({std::to_string(model.images.size()), camera});
  for (int k = -20; k <= 20; ++k) {
    Track track{{0.2 * k, kDistance, 0.1 * (k % 5)}, {}};
    for (std::uint32_t i = 0; i < cameras.size(); ++i) track.observations.push_back({i, {1, 1}});
    model.tracks.push_back(std::move(track));
  }
  const std::vector<std::uint32_t> sources = depthSources(model, views, tracksOfImages(model), 0);
  const auto towards = [&](std::uint32_t node) {
    return std::ranges::any_of(sources, [&](std::uint32_t v) {
      return views[v].node == node && -(views[v].camera.pose.rotation * glm::dvec3(0, 0, 1)).y > 0.9;
    });
  };
  CHECK(towards(1));
  CHECK(towards(2));
  CHECK(towards(3));
  const auto face = std::uint32_t(
      std::ranges::find_if(views,
                           [](const DepthView& view) {
                             return view.isFace && -(view.camera.pose.rotation * glm::dvec3(0, 0, 1)).y > 0.9;
                           }) -
      views.begin());
  const std::vector<std::uint32_t> ofFace = depthSources(model, views, tracksOfImages(model), face);
  CHECK_FALSE(ofFace.empty());
  for (const std::uint32_t v : ofFace) CHECK(views[v].node != views[face].node);
}
