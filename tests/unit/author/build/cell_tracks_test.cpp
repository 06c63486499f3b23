// SPDX-License-Identifier: Apache-2.0
#include "author/build/cell_tracks.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "scene/synth/synthetic.h"

using namespace ibr;

namespace {

constexpr double kWall = 4;

// Two photographs of a wall, then two panoramas of it; a cell each.
SyntheticScene wall() {
  SyntheticOptions options;
  for (const double x : {0.0, 0.5}) options.cameras.push_back({pinholeFromFov(96, 72, 0.9), {{x, 0, 0}, {1, 0, 0, 0}}});
  for (const double x : {1.0, 1.5})
    options.cameras.push_back({{CameraModel::equirectangular, 128, 64}, {{x, 0.1, 0}, {1, 0, 0, 0}}});
  options.planes = {{.origin = {0, 0, -kWall}, .extentU = 40, .extentV = 40, .wavelength = 1}};
  options.cells = {{0, 1}, {2, 3}};
  options.gridStep = 2;
  options.samplesPerAxis = 1;
  return makeScene(options);
}

}  // namespace

TEST_CASE("photographs without tracks have vertices of their cells, where the surface is") {
  const SyntheticScene made = wall();
  const std::vector<Track> tracks = cellTracks(made.scene, {false, false, false, true});
  REQUIRE(tracks.size() > 50);
  CHECK(tracks.size() < 3 * kTracksOfCell);
  for (const Track& track : tracks) {
    CHECK(track.position.z == Approx(-kWall).epsilon(1e-3));
    REQUIRE(track.observations.size() == 2);
    for (std::size_t m = 0; m < 2; ++m) {
      CHECK(track.observations[m].image == 2 + m);
      const Camera& camera = made.scene.nodes[2 + m].camera;
      const glm::dvec3 seen = camera.pose.rotation * unproject(camera.intrinsics, track.observations[m].pixel);
      CHECK(glm::dot(seen, glm::normalize(track.position - camera.pose.position)) == Approx(1).margin(1e-5));
    }
  }
}

TEST_CASE("cells whose photographs all have tracks give none") {
  const SyntheticScene made = wall();
  CHECK(cellTracks(made.scene, {false, false, false, false}).empty());
  CHECK(cellTracks(made.scene, {true, false, false, false}).front().observations.front().image == 0);
  CHECK(cellTracks({}, {}).empty());
}
