// SPDX-License-Identifier: Apache-2.0
#include "author/graph/cells.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <numbers>
#include <set>

#include "author/geometry/simplex.h"
#include "ibr/error.h"
#include "support/posed_rig.h"

using namespace ibr;
using namespace ibr::test;

namespace {

constexpr double kPi = std::numbers::pi;

struct Counts {
  std::size_t lines = 0, triangles = 0, tetrahedra = 0, used = 0;
};
Counts count(const CellPlan& plan) {
  Counts counts;
  std::set<std::uint32_t> used;
  for (const auto& cell : plan.cells) {
    (cell.size() == 2 ? counts.lines : cell.size() == 3 ? counts.triangles : counts.tetrahedra)++;
    used.insert(cell.begin(), cell.end());
  }
  counts.used = used.size();
  return counts;
}

CellPlan plan(const std::vector<Camera>& cameras, int dimension = 0) {
  glm::dvec3 middle(0.0);
  double extent = 1e-3;
  for (const Camera& c : cameras) middle += c.pose.position / double(cameras.size());
  for (const Camera& c : cameras) extent = std::max(extent, glm::distance(middle, c.pose.position));
  BuildOptions options;
  options.dimension = dimension;
  return planCells(modelOf(cameras, pointsAround(middle, 20 * extent, 6000)), options);
}

class Noise {
 public:
  glm::dvec3 operator()(double size) { return size * glm::dvec3(normal_(random_), normal_(random_), normal_(random_)); }

 private:
  std::mt19937_64 random_{3};
  std::normal_distribution<double> normal_;
};

// Cameras on a grid; each position has `yaws` directions around the vertical.
std::vector<Camera> grid(int nx, int ny, int nz, int yaws, double noise, double spread = 0) {
  std::vector<Camera> cameras;
  Noise jitter;
  for (int z = 0; z < nz; ++z)
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x) {
        const glm::dvec3 spot = glm::dvec3(x, y, z) + jitter(noise);
        for (int k = 0; k < yaws; ++k) {
          const double angle = 2 * kPi * k / yaws;
          cameras.push_back(lookingAlong(spot + jitter(spread), {std::cos(angle), std::sin(angle), 0}));
        }
      }
  return cameras;
}

// Returns the volume, area or length that the cells of one direction cover.
double covered(const std::vector<Camera>& cameras, const CellPlan& plan, std::size_t members, glm::dvec3 direction) {
  double sum = 0;
  for (const auto& cell : plan.cells) {
    if (cell.size() != members || glm::dot(viewAxis(cameras[cell[0]].pose), direction) < 0.99) continue;
    std::vector<glm::dvec3> p;
    for (const std::uint32_t i : cell) p.push_back(cameras[i].pose.position - cameras[cell[0]].pose.position);
    sum += members == 4   ? std::abs(glm::dot(glm::cross(p[1], p[2]), p[3])) / 6
           : members == 3 ? glm::length(glm::cross(p[1], p[2])) / 2
                          : glm::length(p[1]);
  }
  return sum;
}

}  // namespace

TEST_CASE("a grid in space becomes tetrahedra that fill it, identical for each direction") {
  const double noise = GENERATE(0.0, 0.01);
  const auto cameras = grid(3, 2, 2, 8, noise, noise / 10);
  const CellPlan cells = plan(cameras);
  CHECK(cells.ordered);
  const Counts counts = count(cells);
  CHECK(counts.tetrahedra >= 8 * 10);
  CHECK(counts.tetrahedra <= 8 * 14);
  CHECK(counts.triangles + counts.lines == 0);
  CHECK(counts.used == cameras.size());
  std::set<std::set<std::uint32_t>> spotsOfDirection[8];
  for (const auto& cell : cells.cells) {
    std::set<std::uint32_t> spots;
    for (const std::uint32_t i : cell) {
      CHECK(i % 8 == cell[0] % 8);
      spots.insert(i / 8);
    }
    spotsOfDirection[cell[0] % 8].insert(spots);
  }
  for (int k = 1; k < 8; ++k) CHECK(spotsOfDirection[k] == spotsOfDirection[0]);
  CHECK(covered(cameras, cells, 4, {1, 0, 0}) == Approx(2.0).epsilon(0.06));
}

TEST_CASE("with at most triangles, a grid's cells lie in the grid's planes and cover them once") {
  const double noise = GENERATE(0.0, 0.01);
  const auto cameras = grid(3, 2, 2, 1, noise);
  const CellPlan cells = plan(cameras, 2);
  CHECK(count(cells).triangles == 22);  // 2 triangles for each of 11 squares
  CHECK(count(cells).lines == 0);
  double ground = 0;
  for (const auto& cell : cells.cells) {
    if (std::any_of(cell.begin(), cell.end(), [&](std::uint32_t i) { return cameras[i].pose.position.z > 0.5; }))
      continue;
    const glm::dvec3 a = cameras[cell[0]].pose.position, b = cameras[cell[1]].pose.position,
                     c = cameras[cell[2]].pose.position;
    ground += 0.5 * glm::length(glm::cross(b - a, c - a));
  }
  CHECK(ground == Approx(2.0).epsilon(0.05));
}

TEST_CASE("with at most lines, a grid's cells are its edges") {
  const Counts counts = count(plan(grid(3, 2, 2, 1, 0.0), 1));
  CHECK(counts.lines == 20);
  CHECK(counts.triangles + counts.tetrahedra == 0);
}

TEST_CASE("a noisy plane of cameras becomes triangles, not slivers") {
  std::vector<Camera> cameras;
  Noise jitter;
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 5; ++x)
      cameras.push_back(lookingAlong(glm::dvec3(x, y, 8) + jitter(0.02), {0, 0, -1}, 200, 150, 0.9, {0, 1, 0}));
  const CellPlan cells = plan(cameras);
  CHECK_FALSE(cells.ordered);
  CHECK(count(cells).triangles == 24);
  CHECK(count(cells).tetrahedra == 0);
  CHECK(count(cells).used == 20);
  CHECK(covered(cameras, cells, 3, {0, 0, -1}) == Approx(12.0).epsilon(0.05));
}

TEST_CASE("a noisy line and an arc become a chain") {
  std::vector<Camera> cameras;
  Noise jitter;
  const bool arc = GENERATE(false, true);
  for (int i = 0; i < 9; ++i) {
    const double angle = 0.12 * i;
    cameras.push_back(
        arc ? lookingAlong({10 * std::sin(angle), -10 * std::cos(angle), 0}, {std::sin(angle), -std::cos(angle), 0})
            : lookingAlong(glm::dvec3(i, 0, 0) + jitter(0.02), {0, 1, 0}));
  }
  const CellPlan cells = plan(cameras, arc ? 1 : 0);
  CHECK(count(cells).used == 9);
  for (std::uint32_t i = 0; i < 8; ++i)
    CHECK(std::count(cells.cells.begin(), cells.cells.end(), std::vector<std::uint32_t>{i, i + 1}) == 1);
  CHECK(cells.cells.size() == 8);
}

TEST_CASE("three capture sites with five directions each give five triangles") {
  std::vector<Camera> cameras;
  for (const glm::dvec3 spot : {glm::dvec3(0, 0, 0), {1, 0, 0}, {0.4, 0.9, 0}})
    for (int k = 0; k < 5; ++k)
      cameras.push_back(lookingAlong(spot, {std::cos(2 * kPi * k / 5), std::sin(2 * kPi * k / 5), 0}));
  const CellPlan cells = plan(cameras);
  CHECK(cells.cells.size() == 5);
  CHECK(count(cells).triangles == 5);
  CHECK(cells.ordered);
}

TEST_CASE("two cameras give one cell, and rigs that span nothing give none") {
  const Camera one = lookingAlong({0, 0, 0}, {0, 1, 0}), beside = lookingAlong({1, 0, 0}, {0, 1, 0});
  const Camera away = lookingAlong({1, 0, 0}, {0, -1, 0});
  CHECK(planCells({}, {}).cells.empty());
  CHECK(plan({one, beside}).cells == std::vector<std::vector<std::uint32_t>>{{0, 1}});
  for (const auto& rig : {std::vector<Camera>{one}, {one, one}, {one, one, one, one}, {one, away}}) {
    const CellPlan cells = plan(rig);
    CHECK(cells.cells.empty());
    REQUIRE(cells.unused.size() == rig.size());  // each photograph is listed with the reason
    CHECK(cells.unused[0].name == "000.png");
    CHECK_FALSE(cells.unused[0].reason.empty());
  }
  // Coincident cameras at two positions: each cell joins the two positions, and all photographs are used.
  const CellPlan pairs = plan({one, one, beside, beside});
  CHECK(count(pairs).used == 4);
  for (const auto& cell : pairs.cells) {
    REQUIRE(cell.size() == 2);
    CHECK(cell[0] / 2 != cell[1] / 2);
  }
}

TEST_CASE("an outlier does not merge all other cameras into one capture site") {
  std::vector<Camera> cameras;
  for (int i = 0; i < 12; ++i) cameras.push_back(lookingAlong({i % 4, i / 4, 0}, {0, 0, -1}, 200, 150, 0.9, {0, 1, 0}));
  cameras.push_back(lookingAlong({500, 0, 0}, {0, 0, -1}, 200, 150, 0.9, {0, 1, 0}));
  const CellPlan cells = plan(cameras);
  CHECK(count(cells).triangles >= 12);
  CHECK(count(cells).used >= 12);
  CHECK(covered(cameras, cells, 3, {0, 0, -1}) == Approx(6.0));
}

TEST_CASE("photographs that share too few points make no cell, and the reason is reported") {
  std::vector<Camera> cameras;
  for (int i = 0; i < 3; ++i) cameras.push_back(lookingAlong({i % 2, i / 2, 0}, {0, 1, 0}));
  PosedModel model = modelOf(cameras, pointsAround({0, 0, 0}, 30, 3000));
  REQUIRE(planCells(model, {}).cells.size() == 1);
  // Image 2 loses its tracks; the edge between the other two remains.
  for (Track& track : model.tracks)
    std::erase_if(track.observations, [](const TrackObservation& o) { return o.image == 2; });
  const CellPlan cells = planCells(model, {});
  CHECK(cells.cells == std::vector<std::vector<std::uint32_t>>{{0, 1}});
  REQUIRE(cells.unused.size() == 1);
  CHECK(cells.unused[0].name == "002.png");
  CHECK_THAT(cells.unused[0].reason, Catch::Contains("points"));
  CHECK_THAT(cells.dropped.at(0).reason, Catch::Contains("002.png") && Catch::Contains(" 0 "));
  CHECK_THROWS_AS(planCells(model,
                            [] {
                              BuildOptions o;
                              o.dimension = 4;
                              return o;
                            }()),
                  Error);
}

TEST_CASE("cells do not depend on the order of images and tracks or on the world's frame") {
  const auto cameras = grid(3, 2, 2, 4, 0.02);
  const PosedModel model = modelOf(cameras, pointsAround({1, 0.5, 0.5}, 30, 4000));
  const auto named = [](const PosedModel& m) {
    std::vector<std::vector<std::string>> result;
    for (const auto& cell : planCells(m, {}).cells) {
      result.emplace_back();
      for (const std::uint32_t i : cell) result.back().push_back(m.images[i].name);
    }
    return result;
  };
  const auto expected = named(model);
  REQUIRE(expected.size() > 30);

  PosedModel shuffled = model;
  std::vector<std::uint32_t> order(model.images.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::shuffle(order.begin(), order.end(), std::mt19937_64(5));
  std::vector<std::uint32_t> place(order.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    shuffled.images[i] = model.images[order[i]];
    place[order[i]] = i;
  }
  for (Track& track : shuffled.tracks)
    for (TrackObservation& o : track.observations) o.image = place[o.image];
  std::shuffle(shuffled.tracks.begin(), shuffled.tracks.end(), std::mt19937_64(6));
  CHECK(named(shuffled) == expected);

  PosedModel moved = model;
  const glm::dvec3 offset(5e5, 6e6, 100);
  for (PosedImage& image : moved.images) image.camera.pose.position += offset;
  for (Track& track : moved.tracks) track.position += offset;
  CHECK(named(moved) == expected);

  PosedModel turned = model;
  const double scale = GENERATE(1e-3, 1.0, 700.0);
  const glm::dquat turn = glm::normalize(glm::dquat(0.3, -0.5, 0.7, 0.2));
  for (PosedImage& image : turned.images) {
    image.camera.pose.position = turn * image.camera.pose.position * scale;
    image.camera.pose.rotation = turn * image.camera.pose.rotation;
  }
  for (Track& track : turned.tracks) track.position = turn * track.position * scale;
  CHECK(named(turned) == expected);
}

TEST_CASE("a noisy grid in space has no slivers, and its directions share the same cells") {
  const auto cameras = grid(4, 3, 2, 6, 0.02, 0.002);
  const CellPlan cells = plan(cameras);
  CHECK(count(cells).tetrahedra == 6 * 6 * 6);  // six tetrahedra for each of six cubes, in six directions
  CHECK(cells.cells.size() == 6 * 6 * 6);
  std::map<std::set<std::uint32_t>, int> directions;
  for (const auto& cell : cells.cells) {
    std::vector<glm::dvec3> corners;
    std::set<std::uint32_t> spots;
    for (const std::uint32_t i : cell) {
      corners.push_back(cameras[i].pose.position);
      spots.insert(i / 6);
    }
    CHECK(shape(corners) > 0.5);
    ++directions[spots];
  }
  for (const auto& [spots, number] : directions) CHECK(number == 6);
}

TEST_CASE("directions that lack a capture site share the remaining cells") {
  auto cameras = grid(3, 3, 1, 4, 0.02, 0.002);
  cameras.erase(cameras.begin() + 4 * 4 + 2);  // the middle position lacks one direction
  const CellPlan cells = plan(cameras);
  std::map<std::vector<std::pair<int, int>>, int> directions;
  for (const auto& cell : cells.cells) {
    std::vector<std::pair<int, int>> spots;
    for (const std::uint32_t i : cell)
      spots.emplace_back(int(std::lround(cameras[i].pose.position.x)), int(std::lround(cameras[i].pose.position.y)));
    std::sort(spots.begin(), spots.end());
    ++directions[spots];
  }
  int whole = 0;
  for (const auto& [spots, number] : directions) whole += number == 4 || number == 3;
  CHECK(whole == 8);  // two triangles a square
}

TEST_CASE("grids with unequal steps are split along their own axes") {
  // Two floors, one close above the other; their spread alone would suggest one plane.
  std::vector<Camera> cameras;
  Noise jitter;
  for (int z = 0; z < 2; ++z)
    for (int y = 0; y < 5; ++y)
      for (int x = 0; x < 6; ++x)
        cameras.push_back(lookingAlong(glm::dvec3(1.5 * x, y, 0.4 * z) + jitter(0.005), {0, 1, 0}));
  const CellPlan cells = plan(cameras);
  CHECK(count(cells).tetrahedra == 6 * 5 * 4);
  CHECK(cells.cells.size() == 6 * 5 * 4);
}

TEST_CASE("rings around an object are joined even if neighbours turn by more than half the field of view") {
  // Twelve photographs at steps of 30°; half the smaller field of view is 25.8°.
  std::vector<Camera> cameras;
  for (int i = 0; i < 12; ++i) {
    const double angle = kPi * i / 6;
    const glm::dvec3 out(std::cos(angle), std::sin(angle), 0);
    cameras.push_back(lookingAlong(3.0 * out, -out));
  }
  const PosedModel model = modelOf(cameras, pointsAround({0, 0, 0}, 0.6, 2000));
  const CellPlan cells = planCells(model, {});
  REQUIRE(cells.cells.size() == 12);
  CHECK(count(cells).lines == 12);
  CHECK(count(cells).used == 12);
  CHECK(cells.unused.empty());
  // Without points there is no evidence that the photographs show the same surface.
  PosedModel bare = model;
  bare.tracks.clear();
  const CellPlan none = planCells(bare, {});
  CHECK(none.cells.empty());
  REQUIRE(none.unused.size() == 12);
  CHECK_THAT(none.unused[0].reason, Catch::Contains("30°"));
}

TEST_CASE("a row of clusters has triangles within clusters and lines between them") {
  std::vector<Camera> cameras;
  Noise jitter;
  for (int cluster = 0; cluster < 3; ++cluster)
    for (int i = 0; i < 9; ++i)
      cameras.push_back(
          lookingAlong(glm::dvec3(40 * cluster + i % 3 + 0.5 * (i / 3), 0, i / 3) + jitter(0.03), {0, 1, 0}));
  const CellPlan cells = plan(cameras);
  CHECK(count(cells).triangles >= 3 * 6);
  CHECK(count(cells).lines == 2);
  CHECK(count(cells).used == 27);
}

TEST_CASE("faces replace failed cells, once each and not inside finished cells") {
  const auto cameras = grid(2, 2, 1, 1, 0.0);
  const PosedModel model = modelOf(cameras, pointsAround({0.5, 0.5, 0}, 20, 4000));
  CellPlanner planner(model, {});
  const CellPlan cells = planner.plan();
  REQUIRE(cells.cells.size() == 2);
  const auto edges = planner.replacementFaces({cells.cells[0]}, {cells.cells[1]});
  REQUIRE(edges.size() == 2);  // the third edge belongs to the other triangle too
  for (const auto& edge : edges) {
    CHECK(edge.size() == 2);
    CHECK_FALSE(std::includes(cells.cells[1].begin(), cells.cells[1].end(), edge.begin(), edge.end()));
  }
  CHECK(planner.replacementFaces(edges, {cells.cells[1]}).empty());
  CHECK(planner.replacementFaces({cells.cells[0]}, {cells.cells[1]}).empty());
  CHECK(planner.score(cells.cells[0]) > 0);
  CHECK(planner.score(cells.cells[0]) <= 1);
}

TEST_CASE("photographs in no cell are reported with a reason") {
  std::vector<Camera> cameras;
  for (int i = 0; i < 3; ++i) cameras.push_back(lookingAlong({i % 2, i / 2, 0}, {0, 1, 0}));
  cameras.push_back(lookingAlong({0.001, 0, 0}, {0, 1, 0}));
  cameras.push_back(lookingAlong({0.5, 0.5, 0}, {0.77, 0.64, 0}));
  const CellPlan cells = plan(cameras);
  std::map<std::string, std::string> why;
  for (const auto& [name, reason] : cells.unused) why[name] = reason;
  CHECK_THAT(why["004.png"], Catch::Contains("50°"));
  CHECK(why.size() == 5 - count(cells).used);
}

TEST_CASE("shape, faces and barycentric coordinates of a simplex are correct") {
  const std::vector<glm::dvec3> regular{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  CHECK(shape(regular) == Approx(1));
  CHECK(shape(std::span(regular).first(3)) == Approx(1));
  CHECK(shape(std::span(regular).first(2)) == 1);
  CHECK(shape(std::vector<glm::dvec3>{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}) == 0);
  CHECK(shape(std::vector<glm::dvec3>{{3, 3, 3}, {3, 3, 3}}) == 0);
  CHECK(faces({1, 5, 7}) == std::vector<Simplex>{{1, 5}, {1, 7}, {5, 7}});

  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-2, 2);
  const double scale = GENERATE(1e-3, 1.0, 1e4);
  const glm::dvec3 offset(GENERATE(0.0, 1e6), 0, -7);
  for (std::size_t d = 2; d <= 4; ++d)
    for (int round = 0; round < 50; ++round) {
      std::vector<glm::dvec3> corners;
      for (const glm::dvec3& c : std::span(regular).first(d))
        corners.push_back(offset + scale * (c + 0.3 * glm::dvec3(uniform(random), uniform(random), uniform(random))));
      std::array<double, 4> weights{};
      double rest = 1;
      for (std::size_t i = 1; i < d; ++i) rest -= weights[i] = uniform(random);
      weights[0] = rest;
      glm::dvec3 foot(0.0);
      for (std::size_t i = 0; i < d; ++i) foot += weights[i] * (corners[i] - corners[0]);
      glm::dvec3 off(0.0);
      if (d == 3) off = scale * glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
      const Location found = locate(corners, corners[0] + foot + off);
      for (std::size_t i = 0; i < 4; ++i) CHECK(found.weights[i] == Approx(weights[i]).margin(1e-5));
      CHECK(found.distance == Approx(glm::length(off)).margin(1e-6 * scale));
    }
}
