// SPDX-License-Identifier: Apache-2.0
// Planning reaches a fixed point if the camera stands still.
#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <numbers>
#include <random>

#include "ibr/frame_plan.h"

using namespace ibr;

namespace {

constexpr double kPi = std::numbers::pi;

using Random = std::mt19937_64;

double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

Camera cameraAt(glm::dvec3 position, double yaw, double pitch = 0) {
  Camera camera;
  camera.intrinsics = pinholeFromFov(480, 270, kPi / 3);
  camera.pose = {position, glm::angleAxis(yaw, glm::dvec3(0, 1, 0)) * glm::angleAxis(pitch, glm::dvec3(1, 0, 0))};
  return camera;
}

// Four points in the picture's corners, each at its own distance.
Cell cellOf(const Scene& scene, std::vector<std::uint32_t> members, Random& random) {
  Cell cell;
  cell.members = std::move(members);
  MorphMesh& mesh = cell.mesh;
  for (const std::uint32_t m : cell.members) {
    const Intrinsics& k = scene.nodes[m].camera.intrinsics;
    mesh.match.push_back({{0, 0}, {k.width, 0}, {0, k.height}, {k.width, k.height}});
    mesh.ratio.push_back({1, 1, 1, 1});
  }
  for (int v = 0; v < 4; ++v) mesh.inverseDistance.push_back(float(uniform(random, 0.02, 0.5)));
  mesh.uncertainty.assign(4, 0.0f);
  mesh.triangles = {{0, 1, 2}, {2, 1, 3}};
  mesh.tier = {0, 0};
  mesh.ecc = {1, 1};
  return cell;
}

// Capture sites on a jittered grid with some photographs each. Cells have two or three photographs of neighbouring
// sites with similar viewing directions.
Scene randomScene(Random& random) {
  Scene scene;
  const int side = 2 + int(random() % 3), directions = 3 + int(random() % 4);
  const double jitter = random() % 2 ? 0.3 : 0;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      for (int d = 0; d < directions; ++d) {
        Node node;
        node.name = fmt::format("{}-{}-{}", x, y, d);
        node.camera =
            cameraAt({x + uniform(random, -jitter, jitter), uniform(random, -jitter, jitter),
                      y + uniform(random, -jitter, jitter)},
                     2 * kPi * d / directions + uniform(random, -jitter, jitter), uniform(random, -jitter, jitter));
        scene.nodes.push_back(node);
      }
  const auto node = [&](int x, int y, int d) { return std::uint32_t((y * side + x) * directions + d % directions); };
  for (int y = 0; y + 1 < side; ++y)
    for (int x = 0; x + 1 < side; ++x)
      for (int d = 0; d < directions; ++d) {
        scene.cells.push_back(cellOf(scene, {node(x, y, d), node(x + 1, y, d), node(x, y + 1, d)}, random));
        scene.cells.push_back(cellOf(scene, {node(x + 1, y + 1, d), node(x + 1, y, d), node(x, y + 1, d)}, random));
        if (random() % 2) scene.cells.push_back(cellOf(scene, {node(x, y, d), node(x + 1, y + 1, d)}, random));
      }
  return scene;
}

}  // namespace

// A change takes a fade in and a fade out. A second change waits for both, and may reveal a third one.
TEST_CASE("a still camera's plan reaches a fixed point within five times switchSeconds") {
  for (unsigned seed = 0; seed < 16; ++seed) {
    Random random(seed);
    const Scene scene = randomScene(random);
    REQUIRE(validate(scene).empty());
    const SceneBounds bounds = sceneBounds(scene);
    RenderSettings settings;
    settings.maxCells = 1 + std::uint32_t(random() % 12);
    settings.alignCells = random() % 5 == 0;
    settings.extrapolationLimit = uniform(random, 0.5, 3);
    const double dt = std::array{1.0 / 90, 1.0 / 30, 0.1}[random() % 3];
    const int maxFrames = 1 + int(std::ceil(settings.switchSeconds / dt)) * 5;
    PlanState walked;
    glm::dvec3 position(1, 0, 1);
    double yaw = 0, pitch = 0;
    const auto planFrom = [&](const PlanState& state) {
      return planFrame(scene, bounds, {{cameraAt(position, yaw, pitch)}, settings, dt}, state).next;
    };
    for (int place = 0; place < 6; ++place) {
      const glm::dvec3 goal(uniform(random, -0.5, 3), uniform(random, -0.3, 0.3), uniform(random, -0.5, 3));
      const double yawGoal = uniform(random, -kPi, kPi), pitchGoal = uniform(random, -0.4, 0.4);
      for (int i = 0; i < 20; ++i) {
        position += 0.1 * (goal - position);
        yaw += 0.1 * (yawGoal - yaw);
        pitch += 0.1 * (pitchGoal - pitch);
        walked = planFrom(walked);
      }
      PlanState state = walked;
      int frames = 0;
      for (PlanState next = planFrom(state); frames < maxFrames && next != state; next = planFrom(state)) {
        state = std::move(next);
        ++frames;
      }
      CAPTURE(seed, place, dt, settings.alignCells, settings.maxCells);
      CHECK(frames < maxFrames);
    }
  }
}
