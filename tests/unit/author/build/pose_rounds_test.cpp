// SPDX-License-Identifier: Apache-2.0
// Pose refinement on synthetic scenes with exact matches: planted errors are recovered, all other values stay.
#include "author/build/pose_refinement.h"

#include <fmt/format.h>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "author/build/dense_tracks.h"
#include "author/geometry/posed_model.h"
#include "ibr/author/poses.h"
#include "lab/generate/synthetic.h"
#include "support/pose_noise.h"
#include "support/posed_rig.h"

using namespace ibr;
using namespace ibr::test;

namespace {

constexpr double kPi = 3.14159265358979;

struct Rig {
  std::vector<glm::dvec3> places{{0, 0, 0}, {1, 0, 0}, {0.4, 0.8, 0}, {1.4, 0.8, 0.1}, {2, 0.1, 0}, {2.4, 0.9, -0.1}};
  std::vector<std::vector<std::uint32_t>> cells{{0, 1, 2}, {1, 2, 3}, {1, 3, 4}, {3, 4, 5}};
  bool atInfinity = false;
};

// Two walls and a board in front; the cells' matches, ρ and a_i are exact.
SyntheticScene exactScene(const Rig& rig) {
  SyntheticOptions options;
  options.planes = {{{1, 0, -8}, {1, 0, 0}, {0, 1, 0}, 24, 16, 1, 0.3},
                    {{-4, 0, -5}, {0, 0, 1}, {0, 1, 0}, 8, 12, 2, 0.3},
                    {{1, 0.4, -4}, {1, 0, 0}, {0, 1, 0}, 1.5, 1, 3, 0.3}};
  for (const glm::dvec3& place : rig.places) {
    const double turn = 0.03 * double(options.cameras.size());
    options.cameras.push_back({pinholeFromFov(240, 180, 1.0), {place, glm::angleAxis(turn, glm::dvec3(0, 1, 0))}});
  }
  options.cells = rig.cells;
  options.gridStep = 8;
  options.samplesPerAxis = 1;
  options.atInfinity = rig.atInfinity;
  return makeScene(options);
}

std::vector<Camera> camerasOf(const Scene& scene) {
  std::vector<Camera> cameras;
  for (const Node& node : scene.nodes) cameras.push_back(node.camera);
  return cameras;
}

// Returns a build's input with these cameras; the points' observations are those of the cameras of `exact`.
BuildInput inputOf(const std::vector<Camera>& cameras, const std::vector<Camera>& exact = {},
                   const std::vector<glm::dvec3>& points = {}) {
  BuildInput input;
  input.model = modelOf(exact.empty() ? cameras : exact, points);
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    input.model.images[i].camera = cameras[i];
    Photograph photograph;
    photograph.name = input.model.images[i].name;
    photograph.camera = cameras[i];
    input.photographs.push_back(photograph);
  }
  input.tracksOf = tracksOfImages(input.model);
  return input;
}

struct Off {
  double turnPx = 0, shift = 0;  // maximum over the cameras
};
Off off(const BuildInput& input, const std::vector<Camera>& exact) {
  std::vector<Pose> are, should;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    are.push_back(input.photographs[i].camera.pose);
    should.push_back(exact[i].pose);
  }
  const SimilarityTransform onto = estimateSimilarity(are, should);
  Off most;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const Pose pose = onto(are[i]);
    most.turnPx = std::max(most.turnPx, angleBetween(pose.rotation, should[i].rotation) * exact[i].intrinsics.fx);
    most.shift = std::max(most.shift, glm::distance(pose.position, should[i].position));
  }
  return most;
}

// Returns 240 points near the wall.
std::vector<glm::dvec3> someOfWall() {
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 240; ++i) points.emplace_back(-2.5 + 0.36 * (i % 20), -1.8 + 0.4 * (i / 20), -8 + 0.3 * (i % 7));
  return points;
}

double furthest(const std::vector<Camera>& a, const BuildInput& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Camera& camera = b.photographs[i].camera;
    most = std::max({most, glm::distance(a[i].pose.position, camera.pose.position),
                     angleBetween(a[i].pose.rotation, camera.pose.rotation),
                     std::abs(a[i].intrinsics.fx / camera.intrinsics.fx - 1)});
  }
  return most;
}

}  // namespace

TEST_CASE("a dense track joins all photographs of its cells that see the same point") {
  const SyntheticScene made = exactScene({});
  const std::vector<BundlePoint> tracks = denseTracks(made.scene.nodes, made.scene.cells);
  CHECK(tracks.size() > 1000);
  std::size_t longest = 0;
  double worst = 0;
  for (const BundlePoint& track : tracks) {
    longest = std::max(longest, track.seen.size());
    for (const auto& [camera, pixel] : track.seen) {
      const auto at = seenAt(made.scene.nodes[camera].camera, track.position);
      REQUIRE(at);
      worst = std::max(worst, glm::distance(*at, pixel));
    }
  }
  CHECK(longest == 5);  // photographs 1 and 3 are in three cells
  CHECK(worst < 1e-3);  // matches are floats, px
}

TEST_CASE("cells that contradict each other give no observations of a photograph") {
  SyntheticScene made = exactScene({});
  const auto seenBy = [&](std::uint32_t seed, std::uint32_t other) {
    std::size_t count = 0;
    for (const BundlePoint& track : denseTracks(made.scene.nodes, made.scene.cells))
      count += track.seen[0].camera == seed && std::ranges::count(track.seen, other, &BundleObservation::camera) > 0;
    return count;
  };
  const std::size_t before = seenBy(1, 3);
  for (glm::vec2& match : made.scene.cells[1].mesh.match[2]) match.x += 5;  // photograph 3, in the cell of 1, 2 and 3
  const std::size_t after = seenBy(1, 3);
  INFO(before << " -> " << after);
  CHECK(after < before / 2);
  CHECK(seenBy(3, 4) > 0);
  CHECK(denseTracks(made.scene.nodes, {}).empty());
}

TEST_CASE("exact poses stay exact") {
  const SyntheticScene made = exactScene({});
  const std::vector<Camera> exact = camerasOf(made.scene);
  BuildInput input = inputOf(exact);
  const PoseRefinement report = refinePoses(input, made.scene.cells);
  CHECK(report.poseChanges.empty());
  REQUIRE_FALSE(report.steps.empty());
  for (const PoseRefinement::Step& step : report.steps) CHECK_FALSE(step.accepted);
  CHECK(report.finalErrors.medianPx < 1e-4);
  CHECK(furthest(exact, input) == 0);
}

TEST_CASE("dense matches alone do not move poses that the model's points confirm") {
  SyntheticScene made = exactScene({});
  const std::vector<Camera> exact = camerasOf(made.scene);
  // All matches are biased alike, as if photographs 2 and 3 were turned by a fifth of a pixel.
  for (Cell& cell : made.scene.cells)
    for (std::size_t i = 0; i < cell.members.size(); ++i)
      if (cell.members[i] == 2 || cell.members[i] == 3)
        for (glm::vec2& match : cell.mesh.match[i]) match += glm::vec2(0.2f, -0.1f);
  for (const double noisePx : {0.0, 0.2}) {
    BuildInput withTracks = inputOf(exact, exact, someOfWall()), alone = inputOf(exact);
    PoseNoise random(5);
    for (Track& track : withTracks.model.tracks)
      for (TrackObservation& seen : track.observations) seen.pixel += glm::dvec2(random.vector(noisePx));
    const PoseRefinement report = refinePoses(withTracks, made.scene.cells);
    INFO(noisePx << " px: " << report.steps.at(1).cellsGainSigmas << ", " << report.steps.at(1).modelGainSigmas);
    CHECK(report.poseChanges.empty());
    CHECK(furthest(exact, withTracks) == 0);
    CHECK(report.steps[1].cellsGainSigmas > 3);
    CHECK(report.steps[1].modelGainSigmas < 0);
    CHECK_FALSE(refinePoses(alone, made.scene.cells).poseChanges.empty());  // the cells are the only information
  }
}

TEST_CASE("a fit to noise is rejected, although its own points improve") {
  const SyntheticScene made = exactScene({});
  const std::vector<Camera> exact = camerasOf(made.scene);
  std::vector<Cell> cells = made.scene.cells;
  for (Cell& cell : cells) cell.mesh.triangles.clear(), cell.mesh.tier.clear();  // so no matches
  for (const unsigned seed : {1u, 2u, 3u}) {
    BuildInput input = inputOf(exact, exact, someOfWall());
    PoseNoise random(seed);
    for (Track& track : input.model.tracks)
      for (TrackObservation& seen : track.observations) seen.pixel += glm::dvec2(random.vector(0.5));
    const PoseRefinement report = refinePoses(input, cells);
    REQUIRE_FALSE(report.steps.empty());
    INFO("seed " << seed << ": " << report.steps[0].modelGainSigmas);
    CHECK(report.cellTracks == 0);
    CHECK(std::isnan(report.steps[0].cellsGainSigmas));
    CHECK(report.initialErrors.medianPx > 0.1);
    CHECK(furthest(exact, input) == 0);
  }
}

TEST_CASE("accurate points of the model suffice, also with wrong dense matches") {
  SyntheticScene made = exactScene({});
  const std::vector<Camera> exact = camerasOf(made.scene), wrong = PoseNoise(3).on(exact, 0.008, 0.01);
  for (Cell& cell : made.scene.cells)
    for (std::size_t i = 0; i < cell.members.size(); ++i)
      for (glm::vec2& match : cell.mesh.match[i]) match += glm::vec2(0.2f * float(cell.members[i] % 3), 0);
  BuildInput input = inputOf(wrong, exact, someOfWall());
  const double before = off(input, exact).turnPx;
  const PoseRefinement report = refinePoses(input, made.scene.cells);
  REQUIRE(report.steps.size() == 3);
  CHECK(report.steps[0].accepted);
  CHECK_FALSE(report.steps[1].accepted);
  INFO(before << " -> " << off(input, exact).turnPx << " px");
  CHECK(off(input, exact).turnPx < before / 4);
}

TEST_CASE("planted pose noise is recovered, also with outliers, and its size is reported") {
  SyntheticScene made = exactScene({});
  const std::vector<Camera> exact = camerasOf(made.scene);
  const double focal = exact[0].intrinsics.fx;
  const std::vector<Camera> wrong = PoseNoise(3).on(exact, 2 / focal, 0.01);
  for (const bool outliers : {false, true}) {
    if (outliers)  // a tenth of all matches, in contiguous regions
      for (Cell& cell : made.scene.cells)
        for (std::size_t p = 0; p < cell.mesh.vertexCount() / 10; ++p) cell.mesh.match[1][p] += glm::vec2(9, -6);
    BuildInput input = inputOf(wrong);
    const Off before = off(input, exact);
    const PoseRefinement report = refinePoses(input, made.scene.cells);
    const Off after = off(input, exact);
    INFO("outliers " << outliers << ": " << before.turnPx << " -> " << after.turnPx << " px, " << before.shift << " -> "
                     << after.shift);
    CHECK(before.turnPx > 1);
    CHECK(after.turnPx < (outliers ? 0.25 : 0.15));
    CHECK(after.shift < 0.006);
    CHECK(report.initialErrors.medianPx > 10 * report.finalErrors.medianPx);
    // The coordinate frame is unchanged: no camera moves further than the noise.
    for (const auto& moved : report.poseChanges) CHECK(moved.rotationPx < 6);
    std::vector<Pose> from, to;
    for (std::size_t i = 0; i < exact.size(); ++i) {
      from.push_back(input.photographs[i].camera.pose);
      to.push_back(wrong[i].pose);
      CHECK((input.model.images[i].camera.pose.position == from.back().position));
    }
    CHECK(estimateSimilarity(from, to).scale == Approx(1).epsilon(1e-6));
  }
}

TEST_CASE("wrong focal lengths are recovered if the poses determine them, and stay shared") {
  Rig rig;
  rig.places = {{0, 0, 0}, {1, 0, 0}, {0.4, 0.8, -1.5}, {1.4, 0.8, 0.8}, {2, 0.1, -1}, {2.4, 0.9, 0.6}};
  const SyntheticScene made = exactScene(rig);
  const std::vector<Camera> exact = camerasOf(made.scene);
  std::vector<Camera> wrong = exact;
  for (Camera& camera : wrong) camera.intrinsics.fx *= 1.01, camera.intrinsics.fy *= 1.01;
  BuildInput input = inputOf(wrong);
  const PoseRefinement report = refinePoses(input, made.scene.cells);
  CHECK(input.photographs[0].camera.intrinsics.fx == Approx(exact[0].intrinsics.fx).epsilon(0.002));
  for (const Photograph& photograph : input.photographs)
    CHECK(photograph.camera.intrinsics == input.photographs[0].camera.intrinsics);
  CHECK(report.poseChanges[0].focalFactor == Approx(1 / 1.01).epsilon(0.002));
  // Focal lengths of a distorting lens stay: its pictures are undistorted with the lens's parameters.
  BuildInput distorted = inputOf(wrong);
  const std::vector<double> k{200, 120, 90, -0.1};
  for (PosedImage& image : distorted.model.images) image.lens = Lens(LensModel::simpleRadial, 240, 180, k);
  refinePoses(distorted, made.scene.cells);
  CHECK(distorted.photographs[3].camera.intrinsics == wrong[3].intrinsics);
}

TEST_CASE("refinement does not depend on the world's position, rotation and scale") {
  const SyntheticScene made = exactScene({});
  const std::vector<Camera> wrong = PoseNoise(3).on(camerasOf(made.scene), 0.008, 0.01);
  BuildInput here = inputOf(wrong);
  refinePoses(here, made.scene.cells);
  const SimilarityTransform move{250, glm::angleAxis(2.0, glm::normalize(glm::dvec3(1, 2, -1))), {4000, -700, 90}};
  std::vector<Camera> moved = wrong, expected;
  for (Camera& camera : moved) camera.pose = move(camera.pose);
  for (const Photograph& photograph : here.photographs) {
    expected.push_back(photograph.camera);
    expected.back().pose = move(expected.back().pose);
  }
  std::vector<Cell> cells = made.scene.cells;
  for (Cell& cell : cells)
    for (float& rho : cell.mesh.inverseDistance) rho /= 250;
  BuildInput there = inputOf(moved);
  refinePoses(there, cells);
  for (std::size_t i = 0; i < wrong.size(); ++i) {
    const Pose& pose = there.photographs[i].camera.pose;
    CHECK(glm::distance(pose.position, expected[i].pose.position) < 250 * 1e-5);
    CHECK(angleBetween(pose.rotation, expected[i].pose.rotation) < 1e-5);
  }
}

TEST_CASE("refinement does not depend on the order of photographs and cells") {
  const SyntheticScene made = exactScene({});
  const std::vector<Camera> wrong = PoseNoise(3).on(camerasOf(made.scene), 0.008, 0.01);
  BuildInput there = inputOf(wrong);
  refinePoses(there, made.scene.cells);
  std::vector<Camera> reversed(wrong.rbegin(), wrong.rend());
  std::vector<Cell> cells(made.scene.cells.rbegin(), made.scene.cells.rend());
  for (Cell& cell : cells)
    for (std::uint32_t& member : cell.members) member = 5 - member;
  BuildInput back = inputOf(reversed);
  refinePoses(back, cells);
  for (std::size_t i = 0; i < wrong.size(); ++i) {
    const Pose &a = there.photographs[i].camera.pose, &b = back.photographs[5 - i].camera.pose;
    CHECK(glm::distance(a.position, b.position) < 1e-5);
    CHECK(angleBetween(a.rotation, b.rotation) < 1e-5);
  }
}

TEST_CASE("degenerate rigs are refined, and an unconnected photograph is unchanged") {
  Rig line;
  line.places = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
  line.cells = {{0, 1}, {1, 2}, {2, 3}};
  Rig two = line;
  two.places.resize(2);
  two.cells.resize(1);
  Rig sky = line;
  sky.atInfinity = true;
  Rig apart = line;
  apart.places.push_back({9, 3, 2});
  for (const Rig& rig : {line, two, sky, apart}) {
    const SyntheticScene made = exactScene(rig);
    const std::vector<Camera> exact = camerasOf(made.scene), wrong = PoseNoise(6).on(exact, 0.004, 0.005);
    BuildInput input = inputOf(wrong);
    const PoseRefinement report = refinePoses(input, made.scene.cells);
    INFO(rig.places.size() << " places, sky " << rig.atInfinity << ", " << report.initialErrors.medianPx << " -> "
                           << report.finalErrors.medianPx << " px");
    CHECK(report.finalErrors.medianPx < 0.02);
    CHECK(report.initialErrors.medianPx > 0.05);
    CHECK(furthest(wrong, input) < 0.1);
    if (rig.places.size() == 5) {
      CHECK(report.poseChanges.size() == 4);
      CHECK((input.photographs[4].camera.pose.position == wrong[4].pose.position));
    }
  }
  BuildInput alone = inputOf({exactScene(two).scene.nodes[0].camera});
  CHECK(refinePoses(alone, {}).poseChanges.empty());
}

TEST_CASE("the model's tracks are updated, and connect photographs that no cell joins") {
  Rig rig;
  rig.cells = {{0, 1, 2}, {3, 4, 5}};
  const SyntheticScene made = exactScene(rig);
  const std::vector<Camera> exact = camerasOf(made.scene), wrong = PoseNoise(3).on(exact, 0.008, 0.01);
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 80; ++i) points.emplace_back(-2 + 0.7 * (i % 10), -1.5 + 0.4 * (i / 10), -8 + 0.3 * (i % 7));
  BuildInput with = inputOf(wrong, exact, points), without = inputOf(wrong);
  refinePoses(with, made.scene.cells);
  refinePoses(without, made.scene.cells);
  INFO(off(without, exact).turnPx << " -> " << off(with, exact).turnPx);
  CHECK(off(with, exact).turnPx < 0.3);
  CHECK(off(without, exact).turnPx > 0.8);
  CHECK(reprojectionError(with.model) < 0.03);
}

TEST_CASE("a similarity is found from positions and rotations, also for degenerate positions") {
  PoseNoise random(8);
  const SimilarityTransform move{3, glm::angleAxis(2.5, glm::normalize(glm::dvec3(1, -2, 0.5))), {7, -2, 100}};
  const auto check = [&](std::vector<Pose> from) {
    std::vector<Pose> to;
    for (Pose& pose : from) to.push_back(move(pose));
    const SimilarityTransform found = estimateSimilarity(from, to);
    for (std::size_t i = 0; i < from.size(); ++i) {
      CHECK(glm::distance(found(from[i]).position, to[i].position) < 1e-7);
      CHECK(angleBetween(found(from[i]).rotation, to[i].rotation) < 1e-7);
    }
    return found;
  };
  const auto pose = [&](glm::dvec3 place) {
    return Pose{place, glm::normalize(glm::angleAxis(random.uniform(0, kPi), glm::normalize(random.vector(1))))};
  };
  CHECK(check({pose({0, 0, 0}), pose({1, 0, 0}), pose({0, 1, 0}), pose({2, 1, 3})}).scale == Approx(3));
  CHECK(check({pose({0, 0, 0}), pose({1, 0, 0}), pose({5, 0, 0})}).scale == Approx(3));  // positions on a line
  CHECK(check({pose({1e6, 0, 0}), pose({1e6 + 1, 0, 0})}).scale == Approx(3));
  CHECK(check({pose({4, 5, 6}), pose({4, 5, 6})}).scale == 1);  // coincident positions
  CHECK(check({pose({4, 5, 6})}).scale == 1);
  CHECK(estimateSimilarity({}, {}).scale == 1);
}
