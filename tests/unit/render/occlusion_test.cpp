// SPDX-License-Identifier: Apache-2.0
// Hidden cells are really covered: covers of outlines, and whole plans.
#include "ibr/frame_plan.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <random>

#include "lab/generate/bench_scene.h"
#include "render/plan/cover_mask.h"
#include "support/flat_triangle.h"

using namespace ibr;

namespace {

using Edges = std::vector<CoverMask::Edge>;

Edges polygon(const std::vector<glm::dvec2>& corners) {
  Edges edges;
  for (std::size_t i = 0; i < corners.size(); ++i) edges.push_back({corners[i], corners[(i + 1) % corners.size()]});
  return edges;
}

Edges rectangle(double left, double top, double right, double bottom) {
  return polygon({{left, top}, {right, top}, {right, bottom}, {left, bottom}});
}

int count(const CoverMask& mask, int columns, int rows) {
  int sum = 0;
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) sum += mask.covered(x, y);
  return sum;
}

std::vector<CoverMask::Rectangle> openOf(CoverMask& mask) {
  std::vector<CoverMask::Rectangle> open;
  mask.forOpen([&](const CoverMask::Rectangle& one) { open.push_back(one); });
  return open;
}

}  // namespace

TEST_CASE("tiles inside an outline are covered, and tiles on it are not") {
  CoverMask mask(160, 96, 1);  // 10 × 6 tiles
  CHECK(openOf(mask).size() == 2);
  mask.add(rectangle(31, -50, 100, 50));
  for (int y = 0; y < 6; ++y)
    for (int x = 0; x < 10; ++x) CHECK(mask.covered(x, y) == (x >= 3 && x <= 5 && y <= 2));
  mask.add(rectangle(-20, -20, 200, 120));
  CHECK(count(mask, 10, 6) == 60);
  CHECK(openOf(mask).empty());
}

TEST_CASE("holes stay open for both orientations, and covers add up") {
  for (const bool reversed : {false, true}) {
    CoverMask mask(160, 160, 1);
    Edges outline = rectangle(-9, -9, 169, 169), hole = polygon({{50, 50}, {50, 60}, {60, 60}, {60, 50}});
    outline.insert(outline.end(), hole.begin(), hole.end());
    if (reversed)
      for (CoverMask::Edge& edge : outline) std::swap(edge.from, edge.to);
    mask.add(outline);
    CHECK(count(mask, 10, 10) == 99);
    CHECK_FALSE(mask.covered(3, 3));
    const auto open = openOf(mask);
    REQUIRE(open.size() == 1);
    CHECK((open[0].left == 47 && open[0].right == 65 && open[0].top == 47 && open[0].bottom == 65));
    mask.add(rectangle(50, 50, 70, 70));
    CHECK(count(mask, 10, 10) == 99);  // the cell's border touches the tile
    mask.add(rectangle(40, 40, 70, 70));
    CHECK(mask.covered(3, 3));
  }
}

TEST_CASE("no open point is marked as covered by any triangles") {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> at(-60, 260);
  int covered = 0;
  for (int round = 0; round < 60; ++round) {
    CoverMask mask(200, 150, 1);
    std::vector<std::array<glm::dvec2, 3>> triangles;
    Edges edges;
    for (int t = 0; t < 1 + round % 7; ++t) {
      const std::array<glm::dvec2, 3> triangle{
          {{at(random), at(random)}, {at(random), at(random)}, {at(random), at(random)}}};
      triangles.push_back(triangle);
      for (std::size_t e = 0; e < 3; ++e) edges.push_back({triangle[e], triangle[(e + 1) % 3]});
    }
    mask.add(edges);
    for (int y = 0; y < 150; y += 3)
      for (int x = 0; x < 200; x += 3) {
        if (!mask.covered(x / 16, y / 16)) continue;
        ++covered;
        bool any = false;
        for (const auto& triangle : triangles) any |= test::isInside(triangle, {x + 0.5, y + 0.5});
        CHECK(any);
      }
  }
  CHECK(covered > 1000);
}

TEST_CASE("an edge with a margin covers no tile within the margin, and winds as its chain does") {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> at(-60, 1300), off(-40, 40);
  int covered = 0;
  for (int round = 0; round < 40; ++round) {
    CoverMask chained(1200, 700, 1), exact(1200, 700, 1);
    // Each side of a triangle is a chain of 8 edges that leaves the side by at most 40 · √2 px.
    const std::array<glm::dvec2, 3> corner{
        {{at(random), at(random)}, {at(random), at(random)}, {at(random), at(random)}}};
    Edges chains, edges;
    for (std::size_t e = 0; e < 3; ++e) {
      const glm::dvec2 from = corner[e], to = corner[(e + 1) % 3];
      chains.push_back({from, to, 40 * std::sqrt(2.0)});
      glm::dvec2 last = from;
      for (int k = 1; k <= 8; ++k) {
        const glm::dvec2 next = k == 8 ? to : from + k / 8.0 * (to - from) + glm::dvec2(off(random), off(random));
        edges.push_back({last, next});
        last = next;
      }
    }
    chained.add(chains);
    exact.add(edges);
    for (int row = 0; row < 44; ++row)
      for (int column = 0; column < 75; ++column) {
        if (!chained.covered(column, row)) continue;
        ++covered;
        CHECK(exact.covered(column, row));
      }
  }
  CHECK(covered > 1000);
}

TEST_CASE("only the first of stacked cells is drawn, and visible stitched cells are not hidden") {
  const auto plan = [](const char* name, auto change) {
    Scene scene = makeBenchScene(*findBenchShape(name), 0.1);
    change(scene);
    FrameInput input{benchViews(*findBenchShape(name), 2, 640, 360), {}};
    input.settings.maxCells = 64;
    return planFrame(scene, sceneBounds(scene), input);
  };
  const auto hidden = [](const FramePlan& of) {
    return std::ranges::count_if(of.cells, [](const PlannedCell& cell) { return cell.hidden; });
  };
  const auto asItIs = [](Scene&) {};
  CHECK(hidden(plan("stacked-12", asItIs)) == 11);
  const FramePlan stitched = plan("stitched-5", asItIs);
  CHECK(hidden(stitched) == 0);
  CHECK(hidden(plan("stitched-30", asItIs)) > 0);
  // A hole of one triangle in every cell's middle shows the next cell.
  const FramePlan holes = plan("stacked-5", [](Scene& scene) {
    for (Cell& cell : scene.cells) {
      const std::size_t middle = cell.mesh.triangles.size() / 2;  // middle row, middle quad
      cell.mesh.tier[middle] = kTierRejected;
      std::swap(cell.mesh.tier[middle], cell.mesh.tier.back());
      std::swap(cell.mesh.triangles[middle], cell.mesh.triangles.back());
    }
  });
  CHECK_FALSE(holes.cells[1].hidden);
  // Panoramas surround the camera, so there is no outline in front.
  CHECK(hidden(plan("panorama-3", asItIs)) == 0);
}

TEST_CASE("dissolving cells and the paper's draw order hide nothing") {
  const BenchShape& shape = *findBenchShape("stacked-5");
  const Scene scene = makeBenchScene(shape, 0.1);
  FrameInput input{benchViews(shape, 1, 640, 360), {}};
  const auto anyHidden = [&] {
    const FramePlan plan = planFrame(scene, sceneBounds(scene), input);
    return std::ranges::any_of(plan.cells, [](const PlannedCell& cell) { return cell.hidden; });
  };
  CHECK(anyHidden());
  input.settings.order = DrawOrder::paper;
  CHECK_FALSE(anyHidden());
  input.settings.order = DrawOrder::ours;
  input.settings.colourMapping = ColourMapping::paper;
  CHECK_FALSE(anyHidden());
  input.settings.colourMapping = ColourMapping::off;
  input.views[0].pose.position += glm::dvec3(0.75, 0, 0);  // outside the cell, before the extrapolation limit
  input.settings.fadeShare = 1;
  const FramePlan plan = planFrame(scene, sceneBounds(scene), input);
  REQUIRE(!plan.cells.empty());
  CHECK(plan.cells[0].opacity < 1);
  CHECK_FALSE(anyHidden());
}
