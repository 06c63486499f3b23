// SPDX-License-Identifier: Apache-2.0
#include "author/build/assumed_tracks.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

using namespace ibr;

namespace {

// One photograph and two panoramas at distances of 2 and 3.
const std::vector<Camera> kCameras{{pinholeFromFov(96, 72, 0.9), {{0, 0, 0}, {1, 0, 0, 0}}},
                                   {{CameraModel::equirectangular, 128, 64}, {{2, 0, 0}, {0.6, 0, 0.8, 0}}},
                                   {{CameraModel::equirectangular, 128, 64}, {{5, 0, 0}, {1, 0, 0, 0}}}};

}  // namespace

TEST_CASE("photographs without points get assumed points, at distances of the capture's spacing") {
  const std::vector<Track> tracks = assumedTracks(kCameras, {true, true, false});
  REQUIRE(!tracks.empty());
  double nearest = 1e9, farthest = 0;
  std::vector<std::size_t> count(3, 0);
  for (const Track& track : tracks) {
    REQUIRE(track.observations.size() == 1);
    const auto& [image, pixel] = track.observations.front();
    ++count[image];
    const Camera& camera = kCameras[image];
    const glm::dvec3 to = track.position - camera.pose.position;
    const auto seen = project(camera.intrinsics, glm::conjugate(camera.pose.rotation) * to);
    REQUIRE(seen);
    CHECK(glm::distance(*seen, pixel) < 1e-9);
    nearest = std::min(nearest, glm::length(to));
    farthest = std::max(farthest, glm::length(to));
  }
  CHECK(count == std::vector<std::size_t>{count[1], count[1], 0});
  CHECK(nearest == Approx(2));  // the median of 2, 2 and 3
  CHECK(farthest == Approx(40));
}

TEST_CASE("photographs with points get no assumed points") {
  CHECK(assumedTracks(kCameras, {false, false, false}).empty());
  CHECK(assumedTracks({}, {}).empty());
}
