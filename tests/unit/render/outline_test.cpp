// SPDX-License-Identifier: Apache-2.0
// Outlines of bounded length stay conservative: what they cover, the mesh's triangles cover.
#include "render/plan/outline.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "ibr/frame_plan.h"
#include "support/flat_triangle.h"
#include "support/plan_scenes.h"

using namespace ibr;

namespace {

// Three photographs near each other and one cell of quads × quads.
Scene wall(int quads, unsigned seed = 3) {
  std::mt19937_64 random(seed);
  Scene scene;
  for (const glm::dvec3 at : {glm::dvec3(0, 0, 0), glm::dvec3(0.5, 0, 0.1), glm::dvec3(0.2, 0.1, 0.5)}) {
    Node node;
    node.name = std::to_string(scene.nodes.size());
    node.camera = test::planCamera(at, 0);
    scene.nodes.push_back(node);
  }
  test::addPlanCell(scene, {0, 1, 2}, quads, random);
  return scene;
}

// Removes triangles for which `gone` holds: they get tier 1.
template <class Gone>
void reject(MorphMesh& mesh, Gone&& gone) {
  std::vector<glm::uvec3> kept, rejected;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) (gone(t) ? rejected : kept).push_back(mesh.triangles[t]);
  for (std::size_t t = 0; t < mesh.tier.size(); ++t) mesh.tier[t] = t < kept.size() ? kTierConsistent : kTierRejected;
  kept.insert(kept.end(), rejected.begin(), rejected.end());
  mesh.triangles = kept;
}

std::array<glm::dvec2, 3> seen(const Scene& scene, const Cell& cell, const Camera& view, const PlannedCell& planned,
                               Morph morph, glm::uvec3 triangle) {
  std::array<glm::dvec2, 3> pixels;
  for (int v = 0; v < 3; ++v) {
    const std::uint32_t p = triangle[v];
    glm::dvec3 direction(0.0), shift = -view.pose.position;
    const auto& weights = planned.view[0].position;
    for (std::size_t i = 0; i < cell.members.size(); ++i) {
      const Camera& camera = scene.nodes[cell.members[i]].camera;
      const double ratio = morph == Morph::ours ? double(cell.mesh.ratio[i][p]) : 1.0;
      direction += weights[i] * ratio * (camera.pose.rotation * unproject(camera.intrinsics, cell.mesh.match[i][p]));
      shift += weights[i] * camera.pose.position;
    }
    if (morph == Morph::ours) direction += double(cell.mesh.inverseDistance[p]) * shift;
    pixels[std::size_t(v)] =
        project(view.intrinsics, glm::conjugate(view.pose.rotation) * direction).value_or(glm::dvec2(-1e9));
  }
  return pixels;
}

}  // namespace

TEST_CASE("an outline that is short enough is the mesh's border, edge for edge") {
  const Scene scene = wall(20);
  const CellBounds bounds = sceneBounds(scene).cells[0];
  CHECK(bounds.outline.size() == 80);
  CHECK(bounds.corners.size() == 80);
  for (const CellBounds::OutlineEdge& edge : bounds.outline) {
    CHECK(edge.deviation == std::array<float, 4>{});
    CHECK(edge.inverseDistanceDeviation == 0);
    CHECK(std::ranges::count(bounds.outline, edge.from, &CellBounds::OutlineEdge::to) == 1);
  }
}

TEST_CASE("long outlines and many holes are bounded in number") {
  for (const int quads : {60, 150}) {
    Scene scene = wall(quads);
    std::mt19937_64 random(7);
    for (const unsigned holes : {0u, 30u, 7u}) {
      if (holes) reject(scene.cells[0].mesh, [&](std::size_t) { return random() % holes == 0; });
      const CellBounds bounds = sceneBounds(scene).cells[0];
      CHECK(!bounds.outline.empty());
      CHECK(bounds.outline.size() <= kMaxOutlineEdges);
      CHECK(bounds.corners.size() <= kMaxOutlineEdges + 1);
      for (const CellBounds::OutlineEdge& edge : bounds.outline)
        CHECK(std::ranges::all_of(edge.deviation, [](float d) { return std::isfinite(d) && d >= 0; }));
    }
  }
}

TEST_CASE("a mesh with a border as long as its triangles, and one without triangles, have no outline") {
  Scene scene = wall(12);
  reject(scene.cells[0].mesh, [](std::size_t t) { return t % 2 == 0; });
  CHECK(sceneBounds(scene).cells[0].outline.empty());
  reject(scene.cells[0].mesh, [](std::size_t) { return true; });
  CHECK(sceneBounds(scene).cells[0].outline.empty());
}

TEST_CASE("a cell that the outline of another cell hides is behind its triangles") {
  // The second cell is a small patch of the same photographs; where it is hidden, the first one must cover it.
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> unit(-1, 1);
  int hidden = 0, shown = 0;
  for (int repeat = 0; repeat < 100; ++repeat) {
    Scene scene = wall(50, unsigned(repeat % 5));
    const double x = 0.2 + 0.6 * std::abs(unit(random)), y = 0.2 + 0.6 * std::abs(unit(random));
    const double width = 0.02 + 0.2 * std::abs(unit(random));
    // Holes in a part of the mesh; the patch may lie over them.
    const std::size_t first = random() % 2000, holes = random() % 60;
    reject(scene.cells[0].mesh, [&](std::size_t t) { return t >= first && t < first + 60 * holes && t % 120 < holes; });
    Cell patch = scene.cells[0];
    for (std::size_t i = 0; i < 3; ++i)
      for (glm::vec2& at : patch.mesh.match[i])
        at = glm::vec2(640 * x, 480 * y) + float(width) * (at - glm::vec2(320, 240));
    scene.cells.push_back(patch);
    Camera view =
        test::planCamera({0.3 * unit(random), 0.2 * unit(random), 0.3 * unit(random)}, 0.3 * unit(random), 0.9);
    RenderSettings settings;
    settings.morph = repeat % 4 == 0 ? Morph::paper : Morph::ours;
    settings.fadeShare = 0;
    settings.extrapolationLimit = 100;
    const SceneBounds bounds = sceneBounds(scene);
    CHECK(bounds.cells[0].outline.size() <= kMaxOutlineEdges);
    PlanState state;
    state.cells = {{0, 1, false}};  // the whole wall is in front of the patch
    const FramePlan plan = planFrame(scene, bounds, {{view}, settings}, state);
    if (plan.cells.size() != 2 || plan.cells[0].cell != 0) continue;
    if (!plan.cells[1].hidden) {
      ++shown;
      continue;
    }
    ++hidden;
    std::vector<std::array<glm::dvec2, 3>> front;
    const Cell& cell = scene.cells[0];
    for (std::size_t t = 0; t < cell.mesh.tier0Count(); ++t)
      front.push_back(seen(scene, cell, view, plan.cells[0], settings.morph, cell.mesh.triangles[t]));
    const MorphMesh& mesh = scene.cells[1].mesh;
    for (std::size_t t = 0; t < mesh.tier0Count(); t += 97) {
      const auto triangle = seen(scene, scene.cells[1], view, plan.cells[1], settings.morph, mesh.triangles[t]);
      const glm::dvec2 middle = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
      if (!(middle.x > 0 && middle.y > 0 && middle.x < 640 && middle.y < 480)) continue;
      CHECK(std::ranges::any_of(front, [&](const auto& one) { return test::isInside(one, middle); }));
    }
  }
  CHECK(hidden > 20);
  CHECK(shown > 20);
}
