// SPDX-License-Identifier: Apache-2.0
// Plans with the indices of a scene's cells and photographs are those of visiting every cell and photograph.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <random>

#include "ibr/frame_plan.h"
#include "render/plan/culling.h"
#include "support/plan_scenes.h"
#include "support/plan_walks.h"

using namespace ibr;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<Camera> viewsAt(Camera view, bool stereo, double apart) {
  if (!stereo) return {view};
  Camera other = view;
  other.pose.position += view.pose.rotation * glm::dvec3(apart, 0, 0);
  other.pose.rotation = other.pose.rotation * glm::angleAxis(0.1, glm::dvec3(0, 1, 0));
  return {view, other};
}

// Compares two walks, each with its own state. Returns how many cells and photographs were planned.
std::size_t compareWalks(const Scene& scene, const SceneBounds& bounds, const RenderSettings& settings,
                         const std::vector<std::vector<Camera>>& views) {
  const SceneBounds exhaustive = test::withoutIndex(scene, bounds);
  FramePlan plan, reference;
  std::size_t planned = 0;
  for (const std::vector<Camera>& at : views) {
    const FrameInput input{at, settings, 0.03};
    plan = planFrame(scene, bounds, input, plan.next);
    reference = planFrame(scene, exhaustive, input, reference.next);
    if (std::isnan(settings.extrapolationLimit))  // is not equal to itself
      plan.settings.extrapolationLimit = reference.settings.extrapolationLimit = 0;
    REQUIRE(plan == reference);
    planned += plan.cells.size() + plan.photographs.size();
  }
  return planned;
}

// Cells of 2 to 4 photographs anywhere, some of them at one point, and panoramas.
Scene cloud(std::mt19937_64& random, double scale, glm::dvec3 offset) {
  std::uniform_real_distribution<double> unit(-1, 1);
  Scene scene;
  for (int n = 0; n < 60; ++n) {
    Node node;
    node.name = std::to_string(n);
    const glm::dquat turn = glm::normalize(glm::dquat(unit(random), unit(random), unit(random), unit(random)));
    const glm::dvec3 at = 8.0 * glm::dvec3(unit(random), 0.3 * unit(random), unit(random));
    node.camera = {pinholeFromFov(640, 480, 0.6 + 0.5 * std::abs(unit(random))), {offset + scale * at, turn}};
    if (n % 10 == 0) node.camera.intrinsics = {CameraModel::equirectangular, 512, 256, 0, 0, 0, 0};
    if (n % 7 == 6) node.camera.pose.position = scene.nodes[std::size_t(n) - 1].camera.pose.position;
    if (n % 4 != 0) {
      node.depthFile = "depth";
      node.depthScale = 1;
      scene.backdrops.push_back(test::planBackdrop(std::uint32_t(n)));
      scene.backdrops.back().mesh.inverseDistance = {float(0.2 / scale)};
    }
    scene.nodes.push_back(node);
  }
  for (int c = 0; c < 150; ++c) {
    Cell cell;
    const auto count = 2 + random() % 3;
    while (cell.members.size() < count) {
      // Mostly neighbours, in the order of the nodes.
      const auto member = std::uint32_t((random() % 5 + std::uint32_t(c) * 2) % scene.nodes.size());
      if (std::ranges::find(cell.members, member) == cell.members.end()) cell.members.push_back(member);
    }
    MorphMesh& mesh = cell.mesh;
    mesh.match.resize(count);
    mesh.ratio.resize(count);
    const bool narrow = c % 3 == 0;  // points in a part of the photographs
    for (int p = 0; p < 6; ++p) {
      for (std::size_t i = 0; i < count; ++i) {
        const Intrinsics& k = scene.nodes[cell.members[i]].camera.intrinsics;
        mesh.match[i].emplace_back(float(k.width * (0.5 + (narrow ? 0.1 : 0.5) * unit(random))),
                                   float(k.height * (0.5 + (narrow ? 0.1 : 0.45) * unit(random))));
        mesh.ratio[i].push_back(float(1 + 0.2 * unit(random)));
      }
      mesh.inverseDistance.push_back(float((0.2 + 0.2 * unit(random)) / scale));
    }
    mesh.uncertainty.assign(6, 0.0f);
    mesh.triangles = {{0, 1, 2}, {1, 2, 3}, {2, 3, 4}, {3, 4, 5}};
    mesh.tier.assign(4, kTierConsistent);
    mesh.ecc.assign(4, 1.0f);
    scene.cells.push_back(cell);
  }
  return scene;
}

}  // namespace

TEST_CASE("along a walk every setting gives the plans of visiting every cell and photograph") {
  const test::PlanSceneShape shape{7, 6, 4, 3, true};
  const Scene scene = test::makePlanScene(shape);
  REQUIRE(validate(scene).empty());
  const SceneBounds bounds = sceneBounds(scene);
  std::size_t planned = 0;
  for (const RenderSettings& settings : test::planSettings())
    for (const bool stereo : {false, true}) {
      std::vector<std::vector<Camera>> views;
      for (int frame = 0; frame < 120; ++frame)
        views.push_back(viewsAt(test::planWalk(shape, 4 * frame, 640, 480), stereo, 0.06));
      planned += compareWalks(scene, bounds, settings, views);
    }
  CHECK(planned > 20000);
}

TEST_CASE("among more photographs than are evaluated, the index finds those of the greatest promise of all") {
  for (const int directions : {5, 8}) {
    const test::PlanSceneShape shape{9, 8, directions, 0, true};
    const Scene scene = test::makePlanScene(shape);
    RenderSettings settings;
    settings.composition = Composition::gathered;
    std::vector<std::vector<Camera>> views;
    for (int frame = 0; frame < 60; ++frame)
      views.push_back(viewsAt(test::planWalk(shape, 9 * frame, 640, 480), frame % 2 == 0, 0.06));
    views.push_back({test::planCamera({100, 3, -50}, 2.0)});
    views.push_back({test::planCamera({1e9, 3, -50}, 1.0)});
    CHECK(compareWalks(scene, sceneBounds(scene), settings, views) > 0);
  }
}

TEST_CASE("random scenes, views and settings give the plans of visiting every cell and photograph") {
  std::mt19937_64 random(21);
  std::uniform_real_distribution<double> unit(-1, 1);
  const std::vector<RenderSettings> all = test::planSettings();
  std::size_t planned = 0;
  for (int repeat = 0; repeat < 24; ++repeat) {
    const double scale = std::array{1.0, 1e-6, 1e5}[std::size_t(repeat % 3)];
    const glm::dvec3 offset = repeat % 4 == 3 ? glm::dvec3(3e8, -2e7, 1e9) : glm::dvec3(0.0);
    const Scene scene = cloud(random, scale, offset);
    const SceneBounds bounds = sceneBounds(scene);
    for (std::size_t s = 0; s < all.size(); ++s) {
      std::vector<std::vector<Camera>> views;
      Camera view;
      for (int frame = 0; frame < 12; ++frame) {
        if (frame % 4 == 0) {
          view = test::planCamera({8 * unit(random), 2 * unit(random), 8 * unit(random)}, 3 * unit(random));
          view.pose.position = offset + scale * view.pose.position;
        }
        view.pose.position += 0.3 * scale * glm::dvec3(unit(random), unit(random), unit(random));
        view.pose.rotation = view.pose.rotation * glm::angleAxis(0.2 * unit(random), glm::dvec3(0, 1, 0));
        views.push_back(viewsAt(view, s % 2 == 0, 0.06 * scale));
      }
      if (repeat % 6 == 0) {  // at a photograph's own position, and as far away as a view may be
        views.push_back({test::planCamera(scene.nodes[5].camera.pose.position, 1)});
        views.push_back({test::planCamera({9e11, 0, -1e11}, 0.5)});
      }
      planned += compareWalks(scene, bounds, all[s], views);
    }
  }
  CHECK(planned > 5000);
}

TEST_CASE("limits that are no numbers, negative or huge give the plans of visiting every cell") {
  const test::PlanSceneShape shape{4, 4, 4, 2};
  Scene scene = test::makePlanScene(shape);
  for (std::size_t n = 0; n < 8; ++n) scene.nodes[n].camera.pose.position = {0, 0, 0};  // cells of size 0
  const SceneBounds bounds = sceneBounds(scene);
  for (const double limit : {std::nan(""), -1.0, -kInfinity, 0.0, 1e-300, 1e300, kInfinity})
    for (const glm::dvec3 position : {glm::dvec3(0, 0, 0), glm::dvec3(1, 0, 1), glm::dvec3(-500, 1, 2)}) {
      RenderSettings settings;
      settings.extrapolationLimit = limit;
      compareWalks(scene, bounds, settings, {{test::planCamera(position, 0.4)}, {test::planCamera(position, 2.4)}});
    }
}

TEST_CASE("cells that are left out are counted, and cells far from the view cost no visits") {
  std::vector<std::uint32_t> visited;
  for (const int side : {20, 80}) {
    const Scene scene = test::makePlanScene({side, side, 1, 1});
    const SceneBounds bounds = sceneBounds(scene);
    const Pose middle{{9.5, 0, 9.5}, glm::dquat(1, 0, 0, 0)};
    std::pmr::vector<std::uint32_t> found;
    const CulledCells culled = findCells(bounds.cells, bounds.index->cells, {middle, 2.0, true, {}}, found);
    CHECK(found.empty());  // no view shows anything
    CHECK(culled.byDistance + culled.byFrustum == scene.cells.size());
    const std::array views{CellQuery::View{frustum(test::planCamera(middle.position, 0)), middle.position}};
    const CulledCells inView = findCells(bounds.cells, bounds.index->cells, {middle, 2.0, true, views}, found);
    CHECK(inView.byDistance + inView.byFrustum + found.size() == scene.cells.size());
    CHECK(std::ranges::is_sorted(found));
    CHECK(!found.empty());
    CHECK(found.size() < 100);
    CAPTURE(side, scene.cells.size(), found.size(), inView.visitedNodes);
    visited.push_back(inView.visitedNodes);
    CHECK(inView.visitedNodes < 8 * found.size());
  }
  // Four more levels of the tree, of two nodes each for every side of the neighbourhood.
  CHECK(visited[1] < visited[0] + 64);
}
