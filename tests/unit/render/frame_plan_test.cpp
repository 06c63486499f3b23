// SPDX-License-Identifier: Apache-2.0
// Choice and order of the planned cells ([T] §2.5.2).
#include <fmt/format.h>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <random>
#include <stop_token>

#include "ibr/error.h"
#include "ibr/frame_plan.h"
#include "render/passes/draw_list.h"
#include "render/plan/anchors.h"
#include "render/plan/cell_distance.h"
#include "support/error_of.h"

using namespace ibr;

namespace {

constexpr double kPi = std::numbers::pi;

Camera cameraAt(glm::dvec3 position, double yaw = 0) {
  Camera camera;
  camera.intrinsics = pinholeFromFov(640, 480, kPi / 3);
  camera.pose = {position, glm::angleAxis(yaw, glm::dvec3(0, 1, 0))};
  return camera;
}

// A mesh of four points in the picture's corners, at distance 1/ρ = 10.
Cell cellOf(const Scene& scene, std::vector<std::uint32_t> members) {
  Cell cell;
  cell.members = std::move(members);
  MorphMesh& mesh = cell.mesh;
  for (std::uint32_t m : cell.members) {
    const Intrinsics& k = scene.nodes[m].camera.intrinsics;
    mesh.match.push_back({{0, 0}, {k.width, 0}, {0, k.height}, {k.width, k.height}});
    mesh.ratio.push_back({1, 1, 1, 1});
  }
  mesh.inverseDistance.assign(4, 0.1f);
  mesh.uncertainty.assign(4, 0.0f);
  mesh.triangles = {{0, 1, 2}, {2, 1, 3}};
  mesh.tier = {0, 0};
  mesh.ecc = {1, 1};
  return cell;
}

// 3×3 sites a metre apart on the ground, four directions each; each small square has two triangles per direction.
Scene stackedGrid() {
  Scene scene;
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 3; ++x)
      for (int direction = 0; direction < 4; ++direction) {
        Node node;
        node.name = fmt::format("{}{}{}", x, y, direction);
        node.camera = cameraAt({x, 0, y}, direction * kPi / 2);
        scene.nodes.push_back(node);
      }
  auto node = [](int x, int y, int direction) { return std::uint32_t((y * 3 + x) * 4 + direction); };
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 2; ++x)
      for (int k = 0; k < 4; ++k) {
        // Member order differs between directions on purpose.
        std::vector<std::uint32_t> lower{node(x, y, k), node(x + 1, y, k), node(x, y + 1, k)};
        std::vector<std::uint32_t> upper{node(x + 1, y + 1, k), node(x + 1, y, k), node(x, y + 1, k)};
        std::rotate(lower.begin(), lower.begin() + k % 3, lower.end());
        scene.cells.push_back(cellOf(scene, lower));
        scene.cells.push_back(cellOf(scene, upper));
      }
  return scene;
}

FramePlan planOf(const Scene& scene, const Camera& view, RenderSettings settings = {}, PlanState state = {}) {
  settings.maxCells = kMaxCellCount;
  return planFrame(scene, sceneBounds(scene), {{view}, settings}, state);
}

}  // namespace

TEST_CASE("a requested stop ends the computation of bounds and anchors before the first cell") {
  std::stop_source stop;
  const Scene scene = stackedGrid();
  CHECK(sceneBounds(scene, false, stop.get_token()).cells.size() == scene.cells.size());
  stop.request_stop();
  CHECK(test::errorOf([&] { sceneBounds(scene, false, stop.get_token()); }).code() == ErrorCode::cancelled);
  CHECK(sceneBounds(Scene{}, false, stop.get_token()).cells.empty());
  SceneBounds::Anchors anchors;
  CHECK(test::errorOf([&] { anchors.of(scene, stop.get_token()); }).code() == ErrorCode::cancelled);
  CHECK(anchors.of(scene).size() == scene.cells.size());  // starts again after the stop
}

TEST_CASE("the main cell contains the camera, and other cells follow by distance, then angle") {
  const Scene scene = stackedGrid();
  REQUIRE(validate(scene).empty());
  const FramePlan plan = planOf(scene, cameraAt({0.3, 0, 0.2}, 0.1));
  REQUIRE(plan.cells.size() > 4);
  CHECK(plan.cells[0].extrapolationDistance == 0);
  CHECK(plan.cells[0].rotationalDistance == Approx(0.1));
  for (std::size_t i = 1; i < plan.cells.size(); ++i) {
    const PlannedCell &a = plan.cells[i - 1], &b = plan.cells[i];
    CHECK((a.extrapolationDistance < b.extrapolationDistance ||
           (a.extrapolationDistance == b.extrapolationDistance && a.rotationalDistance <= b.rotationalDistance)));
  }
  for (const PlannedCell& cell : plan.cells) {
    CHECK(std::accumulate(cell.view[0].blend.begin(), cell.view[0].blend.end(), 0.0) == Approx(1).epsilon(1e-15));
  }
  CHECK(plan.cells.size() + plan.culledByCount + plan.culledByDistance + plan.culledByFrustum == scene.cells.size());
  CHECK(plan.culledByMuting == 0);
}

TEST_CASE("cells behind the view are culled, cells in view never are") {
  const Scene scene = stackedGrid();
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::size_t culled = 0, kept = 0;
  for (int repeat = 0; repeat < 100; ++repeat)
    for (Morph morph : {Morph::ours, Morph::paper}) {
      const Camera view = cameraAt({1 + 2 * unit(random), unit(random), 1 + 2 * unit(random)}, kPi * unit(random));
      RenderSettings settings;
      settings.morph = morph;
      settings.extrapolationLimit = 1e9;
      const FramePlan plan = planOf(scene, view, settings);
      culled += plan.culledByFrustum;
      for (std::uint32_t c = 0; c < scene.cells.size(); ++c) {
        const bool planned = std::any_of(plan.cells.begin(), plan.cells.end(), [&](auto& p) { return p.cell == c; });
        kept += planned;
        if (planned) continue;
        // A culled cell must have no vertex inside the picture.
        const Cell& cell = scene.cells[c];
        const Barycentric b = cellDistance(cellPoses(scene, cell), 1, view.pose).weights;
        const Weights& w = morph == Morph::ours ? b.clamped : b.free;
        for (std::size_t p = 0; p < 4; ++p) {
          glm::dvec3 direction(0.0), shift = -view.pose.position;
          for (std::size_t i = 0; i < cell.members.size(); ++i) {
            const Camera& camera = scene.nodes[cell.members[i]].camera;
            direction += w[i] * (camera.pose.rotation * unproject(camera.intrinsics, cell.mesh.match[i][p]));
            shift += w[i] * camera.pose.position;
          }
          if (morph == Morph::ours) direction += 0.1 * shift;
          const auto pixel = project(view.intrinsics, glm::conjugate(view.pose.rotation) * direction);
          CHECK_FALSE((pixel && pixel->x > 0 && pixel->y > 0 && pixel->x < 640 && pixel->y < 480));
        }
      }
    }
  CHECK(culled > 500);
  CHECK(kept > 500);
}

TEST_CASE("the extrapolation limit is in cell sizes") {
  const Scene scene = stackedGrid();
  RenderSettings settings;
  settings.extrapolationLimit = 0.5;  // of √2 m
  const FramePlan near = planOf(scene, cameraAt({1, 0, 2.6}, 0), settings);
  CHECK_FALSE(near.cells.empty());
  for (const PlannedCell& cell : near.cells) CHECK(cell.extrapolationDistance <= 0.5 * std::sqrt(2.0));
  CHECK(planOf(scene, cameraAt({1, 0, 2.8}, 0), settings).cells.empty());
}

TEST_CASE("the order of cells, members and nodes in the scene does not change the plan", "[N8][T13]") {
  const Scene scene = stackedGrid();
  Scene shuffled = scene;
  std::mt19937_64 random(4);
  std::vector<std::uint32_t> order(scene.cells.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::shuffle(order.begin(), order.end(), random);
  for (std::size_t i = 0; i < order.size(); ++i) shuffled.cells[i] = scene.cells[order[i]];
  // At a vertex of many cells, equally far from all directions, every sort key ties.
  for (const Camera& view :
       {cameraAt({1, 0, 1}, kPi / 4), cameraAt({0.3, 0.1, 0.2}, 0.1), cameraAt({1.5, 0, 1.5}, 0)}) {
    const FramePlan a = planOf(scene, view), b = planOf(shuffled, view);
    REQUIRE(a.cells.size() == b.cells.size());
    for (std::size_t i = 0; i < a.cells.size(); ++i) {
      CHECK(a.cells[i].cell == order[b.cells[i].cell]);
      CHECK(a.cells[i].view == b.cells[i].view);
    }
  }
}

TEST_CASE("moving the world does not change the plan", "[P6]") {
  const Scene scene = stackedGrid();
  const glm::dvec3 offset(1e7, -3e6, 2e5);
  const glm::dquat turn = glm::angleAxis(1.234, glm::normalize(glm::dvec3(1, 2, 3)));
  Scene moved = scene;
  auto move = [&](Camera camera) {
    camera.pose = {offset + turn * camera.pose.position, turn * camera.pose.rotation};
    return camera;
  };
  for (Node& node : moved.nodes) node.camera = move(node.camera);
  const Camera view = cameraAt({0.37, 0.05, 0.21}, 0.1);
  const FramePlan a = planOf(scene, view), b = planOf(moved, move(view));
  REQUIRE(a.cells.size() == b.cells.size());
  for (std::size_t i = 0; i < a.cells.size(); ++i) {
    CHECK(a.cells[i].extrapolationDistance == Approx(b.cells[i].extrapolationDistance).margin(1e-8));
    for (std::size_t m = 0; m < 4; ++m)
      CHECK(a.cells[i].view[0].blend[m] == Approx(b.cells[i].view[0].blend[m]).margin(1e-7));
  }
  CHECK(a.cells[0].cell == b.cells[0].cell);
}

TEST_CASE("a camera that jitters on a border keeps its main cell (N8)", "[N8][T13]") {
  const Scene scene = stackedGrid();
  const SceneBounds bounds = sceneBounds(scene);
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> jitter(-1e-9, 1e-9);
  PlanState state;
  int switches = 0;
  auto step = [&](const Camera& view) {
    const FramePlan plan = planFrame(scene, bounds, {{view}, {}, 0.1}, state);
    switches += state.mainCell >= 0 && plan.next.mainCell != state.mainCell;
    state = plan.next;
  };
  SECTION("along the shared face of two triangles") {
    for (int i = 0; i < 10000; ++i)
      step(cameraAt(
          {0.1 + 0.8 * i / 10000.0 + jitter(random), jitter(random), 0.9 - 0.8 * i / 10000.0 + jitter(random)}));
    CHECK(switches == 0);
  }
  SECTION("across the shared face") {
    for (int i = 0; i < 10000; ++i)
      step(cameraAt({0.2 + 0.5 * i / 10000.0, 0, 0.2 + 0.5 * i / 10000.0 + jitter(random)}));
    CHECK(switches == 1);
  }
  SECTION("looking along equal angular distances") {
    for (int i = 0; i < 10000; ++i) step(cameraAt({0.2, 0, 0.2}, kPi / 4 + jitter(random)));
    CHECK(switches == 0);
  }
  SECTION("turning through equal angular distances") {
    for (int i = 0; i < 10000; ++i) step(cameraAt({0.2, 0, 0.2}, 2 * kPi * i / 10000.0));
    CHECK(switches == 4);
  }
}

TEST_CASE("views that cannot be rendered are refused", "[N16]") {
  const Scene scene = stackedGrid();
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  auto refused = [&](auto change) {
    Camera view = cameraAt({0, 0, 0});
    change(view);
    CHECK_THROWS_AS(planOf(scene, view), Error);
  };
  refused([](Camera& v) { v.intrinsics.model = CameraModel::equirectangular; });
  refused([](Camera& v) { v.intrinsics.width = 0; });
  refused([](Camera& v) { v.intrinsics.fx = 0; });
  refused([&](Camera& v) { v.intrinsics.fy = infinity; });
  refused([&](Camera& v) { v.intrinsics.cx = nan; });
  refused([&](Camera& v) { v.pose.position.y = nan; });
  refused([](Camera& v) { v.pose.rotation *= 2.0; });
  refused([&](Camera& v) { v.pose.rotation.x = nan; });
  CHECK(planOf(Scene{}, cameraAt({0, 0, 0})).cells.empty());
}

TEST_CASE("a switch of the main cell is cross-faded for switchSeconds, then forgotten") {
  const Scene scene = stackedGrid();
  const SceneBounds bounds = sceneBounds(scene);
  const Camera before = cameraAt({0.45, 0, 0.45}), after = cameraAt({0.55, 0, 0.55});
  PlanState state = planFrame(scene, bounds, {{before}, {}, 0.05}, {}).next;
  const std::int64_t first = state.mainCell;
  FramePlan plan = planFrame(scene, bounds, {{after}, {}, 0.05}, state);
  CHECK(plan.next.mainCell != first);
  CHECK(plan.previousWeight == 1);  // the picture does not change in the first frame
  REQUIRE_FALSE(plan.previous.empty());
  CHECK(plan.previous[0].cell == std::uint32_t(first));
  double last = 1;
  for (int frame = 1; frame <= 4; ++frame) {  // of 0.25 s; the main cell stays even if the camera returns
    plan = planFrame(scene, bounds, {{frame % 2 ? before : after}, {}, 0.05}, plan.next);
    CHECK(plan.next.mainCell != first);
    CHECK(plan.previousWeight < last);
    CHECK(plan.previousWeight > 0);
    last = plan.previousWeight;
  }
  plan = planFrame(scene, bounds, {{after}, {}, 0.05}, plan.next);
  CHECK(plan.previousWeight == 0);
  CHECK(plan.previous.empty());
  CHECK(planFrame(scene, bounds, {{before}, {}, 0.05}, plan.next).previousWeight == 1);
  RenderSettings cut;
  cut.switchSeconds = 0;
  CHECK(planFrame(scene, bounds, {{after}, cut, 0.05}, state).previousWeight == 0);
}

TEST_CASE("time between frames is clamped (T18)", "[N9][T18]") {
  const Scene scene = stackedGrid();
  const SceneBounds bounds = sceneBounds(scene);
  PlanState state = planFrame(scene, bounds, {{cameraAt({0.45, 0, 0.45})}, {}, 0}, {}).next;
  state = planFrame(scene, bounds, {{cameraAt({0.55, 0, 0.55})}, {}, 0}, state).next;
  for (const double dt : {0.0, -5.0, std::numeric_limits<double>::quiet_NaN()})
    CHECK_FALSE(planFrame(scene, bounds, {{cameraAt({0.55, 0, 0.55})}, {}, dt}, state).previousWeight < 1);
  for (const double dt : {1e9, std::numeric_limits<double>::infinity()})
    CHECK(planFrame(scene, bounds, {{cameraAt({0.55, 0, 0.55})}, {}, dt}, state).next.secondsSinceSwitch == 0.1);
}

TEST_CASE("both eyes get one draw order of cells, from their midpoint, and their own weights", "[N8]") {
  const Scene scene = stackedGrid();
  // The border of two triangles runs between the eyes.
  const Camera left = cameraAt({0.47, 0, 0.5}), right = cameraAt({0.535, 0, 0.5});
  const FramePlan both = planFrame(scene, sceneBounds(scene), {{left, right}, {}});
  REQUIRE_FALSE(both.cells.empty());
  CHECK(both.views.size() == 2);
  const FramePlan l = planOf(scene, left), r = planOf(scene, right);
  CHECK(l.cells[0].cell != r.cells[0].cell);
  CHECK(both.cells[0].view[0] != both.cells[0].view[1]);
  for (const PlannedCell& cell : both.cells)
    for (const auto& [alone, view] : {std::pair{&l, 0}, std::pair{&r, 1}})
      for (const PlannedCell& other : alone->cells)
        if (other.cell == cell.cell) CHECK(other.view[0] == cell.view[std::size_t(view)]);
  CHECK_THROWS_AS(planFrame(scene, sceneBounds(scene), {{}, {}}), Error);
  CHECK_THROWS_AS(planFrame(scene, sceneBounds(scene), {{left, left, left}, {}}), Error);
}

TEST_CASE("cells dissolve smoothly before the extrapolation limit") {
  const Scene scene = stackedGrid();
  RenderSettings settings;
  settings.extrapolationLimit = 1;
  settings.fadeShare = 0.5;
  double last = 1;
  for (double z = 2; z < 3.5; z += 0.05) {
    const FramePlan plan = planOf(scene, cameraAt({1, 0, z}), settings);
    const double opacity = plan.cells.empty() ? 0 : plan.cells[0].opacity;
    CHECK(opacity <= last);
    CHECK(last - opacity < 0.1);  // no cut
    last = opacity;
  }
  CHECK(last == 0);
}

TEST_CASE("holes are not filled in a scene with a mask, and drawn cells stay the same") {
  Scene scene = stackedGrid();
  const auto maxTier = [&](const RenderSettings& settings) {
    return planOf(scene, cameraAt({0.1, 0, 0.1}), settings).settings.maxTier;
  };
  const RenderSettings balanced = preset(Preset::balanced, DeviceKind::software);
  CHECK(maxTier(balanced) == kTierFilled);
  const FramePlan filled = planOf(scene, cameraAt({0.1, 0, 0.1}), balanced);
  scene.nodes.back().maskFile = "mask.png";
  for (const Preset name : {Preset::fast, Preset::balanced, Preset::accurate, Preset::reference})
    for (const DeviceKind kind : {DeviceKind::software, DeviceKind::hardware})
      CHECK(maxTier(preset(name, kind)) == kTierCompleted);
  CHECK(planOf(scene, cameraAt({0.1, 0, 0.1}), balanced).cells.size() == filled.cells.size());
  RenderSettings few;
  few.maxTier = kTierConsistent;
  CHECK(maxTier(few) == kTierConsistent);
}

TEST_CASE("order changes fade, except with the paper's colour mapping") {
  const Scene scene = stackedGrid();
  const SceneBounds bounds = sceneBounds(scene);
  for (const ColourMapping mapping : {ColourMapping::off, ColourMapping::ours, ColourMapping::paper}) {
    RenderSettings settings;
    settings.colourMapping = mapping;
    settings.fadeShare = 0;
    settings.extrapolationLimit = 100;
    settings.maxCells = 3;
    PlanState state;
    bool faded = false;
    for (int i = 0; i < 200; ++i) {
      const FramePlan plan = planFrame(scene, bounds, {{cameraAt({0.2, 0, 0.2}, 0.03 * i)}, settings, 0.03}, state);
      for (const PlannedCell& cell : plan.cells) faded |= cell.opacity < 1;
      faded |= !plan.fadingOut.empty();
      state = plan.next;
    }
    CHECK(faded == (mapping != ColourMapping::paper));
  }
}

TEST_CASE("the hybrid draws at most two cells, and solo cells are drawn without a gather") {
  Scene scene = stackedGrid();
  for (const std::uint32_t n : {0u, 4u}) {
    Cell backdrop = cellOf(scene, {n});
    backdrop.mesh.confirmations.assign(backdrop.mesh.vertexCount(), 3);
    backdrop.mesh.consensus.assign(backdrop.mesh.vertexCount(), 0.9f);
    scene.nodes[n].depthFile = "depth.ktx2";
    scene.nodes[n].depthScale = 1;
    scene.backdrops.push_back(backdrop);
  }
  const SceneBounds bounds = sceneBounds(scene);
  RenderSettings settings;
  const auto plan = [&](double yaw = 0.1) {
    return planFrame(scene, bounds, {{cameraAt({0.3, 0, 0.2}, yaw)}, settings});
  };
  const FramePlan cells = plan();
  REQUIRE(cells.cells.size() > 3);
  settings.composition = Composition::hybrid;
  const FramePlan hybrid = plan();
  CHECK(hybrid.cells.size() == 1);  // the other cells cover nothing more
  CHECK(hybrid.cells[0].cell == cells.cells[0].cell);
  CHECK(hybrid.photographs.size() == 2);
  CHECK(plan(kPi / 4).cells.size() == 2);  // one on the left, one on the right
  settings.maxCells = 1;
  CHECK(plan().cells.size() == 1);
  settings.maxCells = 12;
  for (const Composition composition : {Composition::hybrid, Composition::gathered}) {
    settings.composition = composition;
    settings.soloCells = {cells.cells[0].cell, cells.cells[1].cell, cells.cells[2].cell};
    const FramePlan solo = plan();
    CHECK(solo.settings.composition == Composition::cells);
    CHECK(solo.photographs.empty());
    CHECK(solo.cells.size() == 3);
  }
}

TEST_CASE("muted cells and cells outside a solo are not planned, and fade out and in") {
  const Scene scene = stackedGrid();
  const SceneBounds bounds = sceneBounds(scene);
  const Camera view = cameraAt({0.3, 0, 0.2}, 0.1);
  const auto plan = [&](const RenderSettings& settings, const PlanState& state = {}) {
    return planFrame(scene, bounds, {{view}, settings, 0.1}, state);
  };
  const FramePlan all = plan({});
  REQUIRE(all.cells.size() > 3);
  const std::uint32_t main = all.cells[0].cell, second = all.cells[1].cell;

  RenderSettings muted;
  muted.mutedCells = {second};
  const FramePlan without = plan(muted);
  CHECK(without.culledByMuting == 1);
  CHECK(without.cells[1].cell == plan({}).cells[2].cell);
  RenderSettings few = muted;  // muted cells do not count for maxCells
  few.maxCells = 2;
  CHECK(plan(few).cells.size() == 2);

  // The muted cell fades out, and fades in again after it is unmuted.
  FramePlan next = plan(muted, all.next);
  REQUIRE(next.fadingOut.size() == 1);
  CHECK(next.fadingOut[0].planned.cell == second);
  CHECK(next.fadingOut[0].planned.opacity == Approx(0.6));
  for (int i = 0; i < 3; ++i) next = plan(muted, next.next);
  CHECK(next.fadingOut.empty());
  next = plan({}, next.next);
  REQUIRE(next.cells[1].cell == second);
  CHECK(next.cells[1].opacity == Approx(0.4));

  // Muting the main cell has the effect of a switch to a better main cell: a cross-fade.
  muted.mutedCells = {main};
  next = plan(muted, all.next);
  CHECK(next.cells[0].cell == second);
  CHECK(next.previousWeight == 1);
  REQUIRE(!next.previous.empty());
  CHECK(next.previous[0].cell == main);

  RenderSettings solo;
  solo.soloCells = {main, 1000};
  CHECK(plan(solo).cells.size() == 1);
  next = plan(solo, all.next);
  CHECK(!next.fadingOut.empty());
  for (int i = 0; i < 3; ++i) next = plan(solo, next.next);
  CHECK(next.fadingOut.empty());
  CHECK(next.cells.size() == 1);
}
