// SPDX-License-Identifier: Apache-2.0
// Cells that share photographs are aligned where both show them ([T] §2.6.4, fig. 14).
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <random>

#include "ibr/frame_plan.h"
#include "lab/generate/synthetic.h"
#include "render/plan/alignment_fit.h"
#include "render/plan/anchors.h"
#include "render/plan/cell_alignment.h"
#include "render/plan/correction.h"
#include "render/plan/culling.h"

using namespace ibr;

namespace {

Camera cameraAt(glm::dvec3 position, double yaw = 0) {
  return {pinholeFromFov(320, 240, 1.2), {position, glm::angleAxis(yaw, glm::dvec3(0, 1, 0))}};
}

// A wall and a board in front, seen from four positions.
Scene sceneOf(std::vector<std::vector<std::uint32_t>> cells, bool atInfinity = false) {
  SyntheticOptions options;
  options.cameras = {cameraAt({0, 0, 0}), cameraAt({1, 0, 0}, 0.05), cameraAt({0.4, 0.9, 0.1}, -0.05),
                     cameraAt({0.9, 0.8, 0.3})};
  options.planes = {{{0, 0, -8}, {1, 0, 0}, {0, 1, 0}, 40, 30, 1, 0.5},
                    {{0.3, 0.2, -4}, {1, 0, 0}, {0, 1, 0}, 1.6, 1.2, 2, 0.25}};
  options.cells = std::move(cells);
  options.gridStep = 16;
  options.samplesPerAxis = 1;
  options.atInfinity = atInfinity;
  return makeScene(options).scene;
}

const std::vector<std::vector<std::uint32_t>> kNeighbours{{0, 1, 2}, {1, 2, 3}};

// Turns the pose of a photograph; node 3 of kNeighbours belongs to cell {1, 2, 3} alone.
Scene turned(Scene scene, std::size_t node, double degrees) {
  glm::dquat& rotation = scene.nodes[node].camera.pose.rotation;
  rotation = glm::angleAxis(glm::radians(degrees), glm::normalize(glm::dvec3(0.3, 1, 0.2))) * rotation;
  return scene;
}

RenderSettings aligned() {
  RenderSettings settings;
  settings.alignCells = true;
  return settings;
}

FramePlan planOf(const Scene& scene, const Camera& view, const RenderSettings& settings = aligned()) {
  return planFrame(scene, sceneBounds(scene), {{view}, settings});
}

double largestMisalignment(const Scene& scene, const FramePlan& plan, bool corrected) {
  const std::vector<double> apart = misalignmentsPx(scene, sceneBounds(scene), plan, 0, corrected);
  REQUIRE(apart.size() > 50);
  return *std::ranges::max_element(apart);
}

double angleOf(const Correction& correction) {
  return 2 * std::atan2(glm::length(glm::dvec3(correction.rotation.x, correction.rotation.y, correction.rotation.z)),
                        std::abs(correction.rotation.w));
}

bool isFinite(const Correction& c) {
  const double sum = c.rotation.w + c.rotation.x + c.rotation.y + c.rotation.z + glm::dot(c.pivot, glm::dvec3(1)) +
                     glm::dot(c.shift, glm::dvec3(1));
  return std::isfinite(sum);
}

glm::dvec3 anyDirection(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
}

// Planted matches of two meshes' points in front of the camera; `motion` displaces the second mesh.
std::vector<ObservationPair> planted(const Motion& motion, std::size_t count, double nearness) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<ObservationPair> pairs;
  for (std::size_t i = 0; i < count; ++i) {
    const Observation from{glm::normalize(anyDirection(random) + glm::dvec3(0, 0, -1.5)), nearness * unit(random)};
    const glm::dvec3 to =
        rotationOf(motion) * from.direction + from.nearness * glm::dvec3(motion[3], motion[4], motion[5]);
    pairs.push_back({from, {glm::normalize(to), from.nearness}, 1});
  }
  return pairs;
}

double largestDifference(const Motion& a, const Motion& b) {
  double largest = 0;
  for (std::size_t i = 0; i < 6; ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

}  // namespace

TEST_CASE("a planted motion is found with a third of the pairs being outliers") {
  const Motion motion{0.004, -0.009, 0.006, 0.01, 0.02, -0.015};
  std::vector<ObservationPair> pairs = planted(motion, 300, 1);
  CHECK(largestDifference(fitMotion(pairs).motion, motion) < 3e-4);
  std::mt19937_64 random(9);
  for (std::size_t i = 0; i < pairs.size(); i += 3)  // a third are outliers: alike, or random
    pairs[i].to.direction =
        glm::normalize(pairs[i].to.direction + 0.05 * (i % 2 ? glm::dvec3(1, 0, 0) : anyDirection(random)));
  CHECK(largestDifference(fitMotion(pairs).motion, motion) < 1.5e-3);
  // At infinity a translation is invisible, so none must be estimated.
  const Motion found = fitMotion(planted({0.004, -0.009, 0.006}, 300, 0)).motion;
  CHECK(largestDifference(found, {0.004, -0.009, 0.006}) < 3e-5);
}

TEST_CASE("undetermined components of the motion stay zero") {
  std::vector<ObservationPair> pairs(20, {{{0, 0, -1}, 0}, {{0, 0, -1}, 0}, 1});
  CHECK(fitMotion(pairs).motion == Motion{});
  for (ObservationPair& pair : pairs) pair.to.direction = glm::normalize(glm::dvec3(0.01, 0, -1));
  const Motion one = fitMotion(pairs).motion;
  CHECK(std::abs(one[1] + 0.01) < 1e-4);  // a turn about the up axis moves −z towards −x
  CHECK(largestDifference(one, {0, one[1]}) < 1e-9);
  CHECK(solved({}, {1, 2, 3, 4, 5, 6}) == Motion{});
}

TEST_CASE("anchors lie on the photograph's ray and on surfaces that every member shows") {
  const Scene scene = sceneOf(kNeighbours);
  const SceneBounds bounds = sceneBounds(scene);
  const SceneBounds::Anchors::OfCells& anchors = bounds.anchors->of(scene);
  CHECK(&anchors == &bounds.anchors->of(scene));  // computed once
  CHECK_FALSE(anchors[0].empty());
  for (std::size_t c = 0; c < 2; ++c)
    for (const CellBounds::Anchor& anchor : anchors[c]) {
      CHECK((anchor.photograph == 1 || anchor.photograph == 2));  // the only photographs that both cells show
      const auto& members = scene.cells[c].members;
      const std::size_t member = std::size_t(std::ranges::find(members, anchor.photograph) - members.begin());
      const auto pixel = project(scene.nodes[anchor.photograph].camera.intrinsics, anchor.point.point[member]);
      REQUIRE(pixel);
      CHECK(std::abs(pixel->x - 320 * (anchor.gridCell % kAnchorSide + 0.5) / kAnchorSide) < 1e-2);
      CHECK(std::abs(pixel->y - 240 * (anchor.gridCell / kAnchorSide + 0.5) / kAnchorSide) < 1e-2);
      // Both planes are perpendicular to the z axis: every member gives the same point on one of the planes.
      for (std::size_t i = 0; i < members.size(); ++i) {
        const Pose& pose = scene.nodes[members[i]].camera.pose;
        const double z =
            (pose.rotation * glm::dvec3(anchor.point.point[i])).z / anchor.point.inverseDistance + pose.position.z;
        CHECK((std::abs(z + 8) < 1e-3 || std::abs(z + 4) < 1e-3));
      }
    }
  CHECK(std::ranges::is_sorted(anchors[0], {},
                               [](const CellBounds::Anchor& a) { return std::pair(a.photograph, a.gridCell); }));
  const Scene lone = sceneOf({{0, 1, 2}});
  CHECK(SceneBounds::Anchors().of(lone).at(0).empty());
}

TEST_CASE("cells that differ because of a wrong pose agree after the correction") {
  const Scene scene = turned(sceneOf(kNeighbours), 3, 0.5);
  const Camera view = cameraAt({0.65, 0.6, 0.15});
  const FramePlan plan = planOf(scene, view);
  REQUIRE(plan.cells.size() == 2);
  CHECK(largestMisalignment(scene, plan, false) > 0.5);
  CHECK(largestMisalignment(scene, plan, true) < 0.1);
  for (const PlannedCell& cell : plan.cells) CHECK(angleOf(cell.correction) < kMaxCorrectionRadians);
  RenderSettings settings;
  settings.alignCells = false;
  for (const PlannedCell& cell : planOf(scene, view, settings).cells) CHECK((cell.correction == Correction{}));
  settings.alignCells = true;
  settings.morph = Morph::paper;
  for (const PlannedCell& cell : planOf(scene, view, settings).cells) CHECK((cell.correction == Correction{}));
}

TEST_CASE("exact scenes and cells without a shared photograph are not corrected") {
  for (const glm::dvec3 place : {glm::dvec3(0.65, 0.6, 0.15), {0.2, 0.1, 0}, {1.4, -0.3, 0.9}})
    for (const Scene& scene : {sceneOf(kNeighbours), turned(sceneOf({{0, 1}, {2, 3}}), 3, 1)})
      for (const PlannedCell& cell : planOf(scene, cameraAt(place)).cells) CHECK((cell.correction == Correction{}));
}

TEST_CASE("at a photograph's pose cells that show the photograph are not corrected") {
  const Scene scene = turned(turned(turned(sceneOf({{0, 1, 2}, {1, 2, 3}, {0, 3}}), 3, 0.5), 0, -0.4), 1, 0.3);
  for (std::uint32_t node = 0; node < 4; ++node) {
    const FramePlan plan = planOf(scene, scene.nodes[node].camera);
    REQUIRE(plan.cells.size() == 3);
    std::size_t others = 0;
    for (const PlannedCell& cell : plan.cells) {
      const bool shows = std::ranges::count(scene.cells[cell.cell].members, node) > 0;
      INFO("photograph " << node << ", cell " << cell.cell);
      if (shows) CHECK((cell.correction == Correction{}));
      others += !shows && angleOf(cell.correction) > 1e-4;
    }
    if (node == 0) CHECK(others == 1);
  }
}

TEST_CASE("corrections do not depend on the order of cells or the world's position and scale") {
  const Scene scene = turned(sceneOf({{0, 1, 2}, {1, 2, 3}, {0, 3}}), 3, 0.5);
  const Camera view = cameraAt({0.65, 0.6, 0.15});
  const FramePlan expected = planOf(scene, view);
  const auto same = [&](const FramePlan& plan, glm::dquat turn, double scale, double tolerance) {
    REQUIRE(plan.cells.size() == expected.cells.size());
    for (std::size_t c = 0; c < plan.cells.size(); ++c) {
      const Correction &a = expected.cells[c].correction, &b = plan.cells[c].correction;
      CHECK(angleOf(a) > 1e-4);
      CHECK(glm::length(glm::axis(b.rotation) * glm::angle(b.rotation) -
                        turn * (glm::axis(a.rotation) * glm::angle(a.rotation))) < tolerance);
      CHECK(glm::length(b.shift / scale - turn * a.shift) < tolerance);
    }
  };
  Scene reversed = scene;
  std::ranges::reverse(reversed.cells);
  same(planOf(reversed, view), {1, 0, 0, 0}, 1, 1e-12);
  const glm::dquat turn = glm::angleAxis(2.1, glm::normalize(glm::dvec3(1, -2, 0.5)));
  for (const double scale : {1.0, 1e-3, 1e3})
    for (const glm::dvec3 offset : {glm::dvec3(0), {1e6, -8e5, 3e5}}) {
      const auto moved = [&](Camera camera) {
        camera.pose = {offset * scale + scale * (turn * camera.pose.position),
                       glm::normalize(turn * camera.pose.rotation)};
        return camera;
      };
      Scene there = scene;
      for (Node& node : there.nodes) node.camera = moved(node.camera);
      for (Cell& cell : there.cells)
        for (float& inverseDistance : cell.mesh.inverseDistance) inverseDistance /= float(scale);
      same(planOf(there, moved(view)), turn, scale, 2e-6);
    }
}

TEST_CASE("corrections are finite for any view") {
  for (const bool atInfinity : {false, true}) {
    Scene scene = turned(sceneOf(kNeighbours, atInfinity), 3, 0.5);
    RenderSettings settings = aligned();
    settings.extrapolationLimit = 1e9;
    for (const glm::dvec3 place : {glm::dvec3(0.65, 0.6, 0.15), {0, 0, 0}, {0.3, 0.2, -4}, {1e6, 0, 1e6}})
      for (const double yaw : {0.0, 3.1}) {
        const Camera view = cameraAt(place, yaw);
        SceneBounds bounds = sceneBounds(scene);
        std::vector<CellToAlign> cells;
        for (std::size_t c = 0; c < 2; ++c)
          cells.push_back({&scene.cells[c], bounds.anchors->of(scene)[c], {0.3, 0.3, 0.4}, 0.1 * double(c)});
        for (const Correction& correction : alignCells(scene, cells, place)) {
          CHECK(isFinite(correction));
          CHECK(angleOf(correction) <= kMaxCorrectionRadians * 1.0001);
        }
        for (const PlannedCell& cell : planOf(scene, view, settings).cells) CHECK(isFinite(cell.correction));
      }
  }
  // All photographs and the eye at one position.
  Scene scene = turned(sceneOf(kNeighbours), 3, 0.5);
  for (Node& node : scene.nodes) node.camera.pose.position = {};
  for (const PlannedCell& cell : planOf(scene, cameraAt({})).cells) CHECK(isFinite(cell.correction));
  CHECK(alignCells(scene, {}, {}).empty());
}

TEST_CASE("both eyes get the same rigid correction") {
  const Scene scene = turned(sceneOf(kNeighbours), 3, 0.5);
  Camera left = cameraAt({0.62, 0.6, 0.15}), right = cameraAt({0.68, 0.6, 0.15});
  const FramePlan plan = planFrame(scene, sceneBounds(scene), {{left, right}, aligned()});
  const Correction& correction = plan.cells[0].correction;
  CHECK(angleOf(correction) > 1e-4);
  CHECK(glm::length(correction.pivot - glm::dvec3(0.65, 0.6, 0.15)) < 1e-12);
  // A point X at distance 1 / ρ from each eye moves to the same point for both eyes.
  const glm::dvec3 point(0.4, 0.2, -4);
  const auto seenFrom = [&](glm::dvec3 eye) {
    return eye + corrected(correction, point - eye, eye);  // Σ λ_i c_i = X, no directions, ρ = 1
  };
  CHECK(glm::length(seenFrom(left.pose.position) - seenFrom(right.pose.position)) < 1e-12);
  CHECK(glm::length(seenFrom(left.pose.position) - point) > 1e-4);
}

TEST_CASE("corrected cells are culled only without a vertex in view or within the margin") {
  const Scene scene = sceneOf(kNeighbours);
  const SceneBounds bounds = sceneBounds(scene);
  const Cell& cell = scene.cells[1];
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::size_t culled = 0, kept = 0, byMargin = 0;
  for (int repeat = 0; repeat < 400; ++repeat) {
    const glm::dvec3 eye(unit(random), unit(random), unit(random));
    const Camera view = cameraAt(eye, 3 * unit(random));
    const Correction correction{glm::angleAxis(0.3 * unit(random), anyDirection(random)), eye + anyDirection(random),
                                0.3 * anyDirection(random)};
    const Placement placement{{0.2, 0.5, 0.3, 0}, Morph::ours, eye, correction};
    const bool visible = mayBeVisible(cellPoses(scene, cell), bounds.cells[1], frustum(view), placement);
    const bool nearly = mayBeVisible(cellPoses(scene, cell), bounds.cells[1], frustum(view), placement, 0.2);
    CHECK((nearly || !visible));
    kept += visible;
    culled += !nearly;
    byMargin += nearly && !visible;
    if (visible) continue;
    const glm::dquat turn = nearly ? glm::dquat(1, 0, 0, 0) : glm::angleAxis(0.2, anyDirection(random));
    glm::dvec3 shift(0.0);
    for (std::size_t i = 0; i < 3; ++i)
      shift += placement.weights[i] * (scene.nodes[cell.members[i]].camera.pose.position - eye);
    shift = corrected(correction, shift, eye);
    for (std::size_t p = 0; p < cell.mesh.vertexCount(); ++p) {
      glm::dvec3 direction = double(cell.mesh.inverseDistance[p]) * shift;
      for (std::size_t i = 0; i < 3; ++i) {
        const Camera& camera = scene.nodes[cell.members[i]].camera;
        direction +=
            placement.weights[i] * double(cell.mesh.ratio[i][p]) *
            (correction.rotation * (camera.pose.rotation * unproject(camera.intrinsics, cell.mesh.match[i][p])));
      }
      const auto pixel = project(view.intrinsics, glm::conjugate(view.pose.rotation) * (turn * direction));
      if (pixel && pixel->x > 0 && pixel->y > 0 && pixel->x < 320 && pixel->y < 240) FAIL("vertex " << p << " in view");
    }
  }
  CHECK(culled > 50);
  CHECK(kept > 50);
  CHECK(byMargin > 3);
}
