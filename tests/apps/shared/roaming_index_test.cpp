// SPDX-License-Identifier: Apache-2.0
// The index of roaming bounds: equal results at a cost that does not grow with the scene.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "shared/camera/roaming.h"

using namespace ibr;
using namespace ibr::app;

namespace {

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  glm::dvec3 vector() { return {any_(engine_), any_(engine_), any_(engine_)}; }  // each coordinate −1 to 1
  std::uint32_t below(std::size_t end) { return std::uint32_t(engine_() % end); }

 private:
  std::mt19937 engine_;
  std::uniform_real_distribution<double> any_{-1, 1};
};

// Lines between random positions.
RoamingBounds lined(std::vector<glm::dvec3> positions, std::size_t lines, unsigned seed) {
  Random random(seed);
  RoamingBounds bounds{std::move(positions), {}, 0.05};
  for (std::size_t i = 0; i < lines && !bounds.positions.empty(); ++i)
    bounds.neighbours.emplace_back(random.below(bounds.positions.size()), random.below(bounds.positions.size()));
  return bounds;
}

RoamingBounds indexed(RoamingBounds bounds) {
  addIndex(bounds);
  return bounds;
}

struct Case {
  std::string name;
  RoamingBounds bounds;
  glm::dvec3 middle{0};
};

std::vector<Case> cases() {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  std::vector<Case> all{
      {"none", {{}, {}, 1}}, {"one", {{{1, 2, 3}}, {}, 0.1}}, {"one and itself", {{{1, 2, 3}}, {{0, 0}}, 0.1}}};
  all.push_back({"at one position", lined(std::vector(200, glm::dvec3(0.1, 0.2, 0.3)), 400, 1)});
  Random random(2);
  for (const double far : {0.0, 1e7}) {
    const glm::dvec3 origin(far, -far, 0.5 * far);
    std::vector<glm::dvec3> scattered, collinear, copies, lattice;
    for (int i = 0; i < 300; ++i) {
      scattered.push_back(origin + random.vector());
      collinear.push_back(origin + random.vector().x * glm::dvec3(0.3, 0.4, -0.5));
      copies.push_back(i % 3 == 0 ? origin + random.vector() : copies.back());
      lattice.push_back(origin + 0.2 * glm::dvec3(i % 7, i / 7 % 6, i / 42) - 0.7);
    }
    all.push_back({"scattered", lined(scattered, 600, 3), origin});
    all.push_back({"points alone", lined(scattered, 0, 3), origin});
    all.push_back({"collinear", lined(collinear, 600, 4), origin});
    all.push_back({"copies", lined(copies, 2000, 5), origin});
    all.push_back({"lattice", lined(lattice, 600, 6), origin});
    scattered[7].y = std::nan("");
    scattered[200].x = kInfinite;
    all.push_back({"not finite", lined(scattered, 600, 7), origin});
  }
  return all;
}

// A lattice of cells of four photographs, which share their photographs with adjacent cells.
Scene latticeScene(int cells) {
  const int side = int(std::lround(std::sqrt(cells))) + 1;
  Scene scene;
  scene.nodes.resize(std::size_t(side) * std::size_t(side));
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) scene.nodes[std::size_t(y * side + x)].camera.pose.position = {x, 0, y};
  for (int y = 0; y + 1 < side; ++y)
    for (int x = 0; x + 1 < side; ++x) {
      const auto at = std::uint32_t(y * side + x), below = at + std::uint32_t(side);
      scene.cells.emplace_back().members = {at, at + 1, below, below + 1};
    }
  return scene;
}

RoamingBounds boundsOf(const Scene& scene) {
  RoamingBounds bounds{{}, cellNeighbours(scene), 0.2};
  for (const Node& node : scene.nodes) bounds.positions.push_back(node.camera.pose.position);
  return bounds;
}

}  // namespace

TEST_CASE("bounds: the index gives exactly the results of the exhaustive search") {
  for (const auto& [name, plain, middle] : cases()) {
    CAPTURE(name, middle.x);
    const RoamingBounds fast = indexed(plain);
    Random random(8);
    std::vector<glm::dvec3> places = plain.positions;
    for (int i = 0; i < 300; ++i) places.push_back(middle + (i % 3 == 0 ? 100.0 : 1.5) * random.vector());
    for (int i = 0; i < 20; ++i) places.push_back(1e9 * random.vector());
    glm::dvec3 last = middle;
    for (const glm::dvec3& place : places) {
      if (!(glm::length(place) < 1e12)) continue;
      const NearestPoint exact = nearestPoint(plain, place), found = nearestPoint(fast, place);
      REQUIRE(found.distance == exact.distance);
      REQUIRE(found.point == exact.point);
      REQUIRE(found.compared <= exact.compared);
      REQUIRE(clampedToBounds(fast, last, place) == clampedToBounds(plain, last, place));
      last = place;
    }
  }
}

TEST_CASE("bounds: the index compares few positions and lines, however many cells the scene has") {
  std::array<std::size_t, 2> most{};
  for (std::size_t i = 0; i < 2; ++i) {
    const Scene scene = latticeScene(i == 0 ? 20000 : 200000);
    const RoamingBounds bounds = indexed(boundsOf(scene));
    REQUIRE(bounds.neighbours.size() > 3 * scene.cells.size());
    const double side = bounds.positions.back().x;
    Random random(9);
    for (int k = 0; k < 500; ++k) {
      const glm::dvec3 share = 0.5 + 0.5 * random.vector();
      const double height = k % 5 == 0 ? 0.1 * side : 0.4;  // some are far outside
      const NearestPoint found = nearestPoint(bounds, glm::dvec3(side, height, side) * share);
      most[i] = std::max(most[i], found.compared);
      REQUIRE(found.distance <= height + 0.3);
    }
    most[i] = std::max(most[i], nearestPoint(bounds, glm::dvec3(10 * side)).compared);
  }
  CHECK(most[1] < 2 * most[0]);
  CHECK(most[1] < 200);
}

TEST_CASE("bounds: photographs at one position are compared once") {
  const RoamingBounds bounds = indexed(lined(std::vector(10000, glm::dvec3(1, 2, 3)), 50000, 10));
  const NearestPoint found = nearestPoint(bounds, {4, 6, 3});
  CHECK(found.compared == 1);
  CHECK(found.distance == 5);
}
