// SPDX-License-Identifier: Apache-2.0
#include "author/htm/htm_shape.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "htm_object.h"
#include "support/error_of.h"
#include "support/test_meshes.h"

namespace ibr {
namespace {

// A wall, a mesh of the wall displaced by bump(v) along the normals, and exact matches of three cameras.
struct Wall {
  TriangleMesh exact, displaced;
  std::vector<HtmView> views;
  std::vector<CameraSet> members;
  std::vector<VertexMatch> matches;

  template <class Bump>
  explicit Wall(const Bump& bump, glm::dvec3 middle = glm::dvec3(0))
      : exact(test::moved(test::flatGrid(8), middle + glm::dvec3(-4, -4, 0))), displaced(exact) {
    const std::vector<glm::dvec3> normals = vertexNormals(exact);
    for (std::size_t v = 0; v < displaced.positions.size(); ++v) displaced.positions[v] += normals[v] * bump(v);
    const double side = normals[0].z > 0 ? 1 : -1;  // sign of the wall's front side
    for (const glm::dvec3& from : {glm::dvec3(-3, 0, 9), {0.3, 2, 10}, {4, -1, 8}})
      views.push_back(test::plainView(test::lookingAt(middle + from * glm::dvec3(1, 1, side), middle, 200, 150)));
    members.assign(displaced.positions.size(), 7);
    match();
  }
  void match() {
    const std::size_t n = displaced.positions.size();
    matches.assign(9 * n, {});
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t v = 0; v < n; ++v) {
        const auto at = PinholeView(views[j].camera).seen(displaced.positions[v]);
        const auto point = at ? test::pointBehind(exact, views[j].camera, at->pixel) : std::nullopt;
        for (std::size_t i = 0; point && i < 3; ++i) {
          if (i == j) continue;
          const PinholeView view(views[i].camera);
          matches[(i * 3 + j) * n + v] = {
              glm::vec2(view.seen(*point)->pixel - view.seen(displaced.positions[v])->pixel), glm::vec3(20, 0, 20), 0};
        }
      }
  }
  std::vector<double> found(double smoothness = 1e-6) const {
    return normalDisplacements(displaced, views, members, matches, {smoothness, 2});
  }
};

}  // namespace

TEST_CASE("errors of vertices along their normals are recovered, one by one or all together") {
  const double far = GENERATE(0.0, 1e6);
  const auto bump = [](std::size_t v) { return 0.05 * std::sin(0.4 * double(v)); };
  const Wall wall(bump, glm::dvec3(far, -far, far));
  const std::vector<double> found = wall.found();
  for (std::size_t v = 0; v < found.size(); ++v) {
    INFO(v);
    if (wall.matches[wall.displaced.positions.size() + v].information != glm::vec3(0))
      CHECK(found[v] == Approx(-bump(v)).margin(0.004));
  }
  const Wall flat([](std::size_t) { return 0.08; }, glm::dvec3(far));
  for (const double smoothness : {1e-3, 1.0, 100.0})
    for (const double moved : flat.found(smoothness)) CHECK(moved == Approx(-0.08).margin(0.006));
}

TEST_CASE("one outlier moves nothing, and vertices without matches follow their neighbours") {
  Wall wall([](std::size_t) { return 0.08; });
  const std::size_t n = wall.displaced.positions.size();
  wall.matches[n + 40].displacement += glm::vec2(30, -20);
  for (std::size_t pair = 0; pair < 9; ++pair) wall.matches[pair * n + 20] = {};
  const std::vector<double> found = wall.found(1);
  CHECK(found[40] == Approx(-0.08).margin(0.01));
  CHECK(found[20] == Approx(-0.08).margin(0.01));
}

TEST_CASE("correct and unmatched vertices stay") {
  Wall wall([](std::size_t) { return 0.0; });
  for (const double moved : wall.found()) CHECK(std::abs(moved) < 1e-4);
  wall.matches.assign(wall.matches.size(), {});
  for (const double moved : wall.found()) CHECK(moved == 0);
  wall.members.assign(wall.members.size(), 0);
  for (const double moved : wall.found()) CHECK(moved == 0);
}

TEST_CASE("cameras that look along the surface do not count") {
  Wall wall([](std::size_t) { return 0.08; });
  for (HtmView& view : wall.views) view.camera = test::lookingAt({30, 0.1, 0.5}, {0, 0, 0}, 200, 150);
  for (const double moved : wall.found()) CHECK(moved == 0);
}

TEST_CASE("outlines move to the masks' borders") {
  const TriangleMesh exact = test::sphere(24);
  const double size = GENERATE(0.96, 1.04);
  TriangleMesh scaled = exact;
  for (glm::dvec3& p : scaled.positions) p *= size;
  std::vector<HtmView> views;
  for (const glm::dvec3& from : {glm::dvec3(6, 0.5, 0), {-5, 1, 4}, {0.5, 1, -6}, {0.3, 6, 0.2}, {2, -5, 2}}) {
    views.push_back(test::plainView(test::lookingAt(from, {0, 0, 0}, 200, 200, 0.6)));
    const MeshRaster seen = rasterised(exact, views.back().camera);
    views.back().mask = Image8(200, 200, 1);
    for (std::size_t p = 0; p < seen.face.values.size(); ++p)
      views.back().mask.values[p] = seen.face.values[p] == MeshRaster::kNone ? 0 : 255;
  }
  const std::vector<CameraSet> members(scaled.positions.size(), 0);
  const std::vector<VertexMatch> matches(views.size() * views.size() * scaled.positions.size());
  const auto mean = [&] {
    double sum = 0;
    for (const double moved : normalDisplacements(scaled, views, members, matches, {1, 2})) sum += moved;
    return sum / double(scaled.positions.size());
  };
  CHECK(mean() == Approx(1 - size).margin(0.015));
  CHECK(normalDisplacements(scaled, views, members, matches, {1, 2, 1}) ==
        normalDisplacements(scaled, views, members, matches, {1, 2, 3}));
  for (HtmView& view : views) view.mask = Image8(200, 200, 1, 255);
  CHECK(mean() == 0);
}

TEST_CASE("adjusting the shape reports progress, and can be cancelled") {
  const Wall wall([](std::size_t v) { return 0.05 * std::sin(0.4 * double(v)); });
  std::size_t last = 1000, calls = 0;
  const auto found = [&] {
    return normalDisplacements(wall.displaced, wall.views, wall.members, wall.matches, {1, 2}, [&](const Progress& p) {
      CHECK(p.done < p.total);
      CHECK(p.total == 103);
      ++calls;
      return p.done < last;
    });
  };
  CHECK(found() == wall.found(1));
  CHECK(calls >= 101);
  for (const std::size_t stop : {0, 3, 50}) {
    last = stop;
    calls = 0;
    CHECK(test::errorOf([&] { found(); }).code() == ErrorCode::cancelled);
    CHECK((stop > 0 || calls == 1));  // no second call after a stop
  }
}

TEST_CASE("vertices next to a camera, far outside its image, do not move to its mask") {
  const TriangleMesh sphere = test::sphere(24);
  HtmView view = test::plainView(test::lookingAt({0, 0, 0}, {0, 0, -1}, 200, 200, 0.38));
  const TriangleMesh moved = test::moved(sphere, {0, 0, -6});
  const MeshRaster seen = rasterised(test::moved(sphere, {0.02, 0, -6}), view.camera);
  view.mask = Image8(200, 200, 1);
  for (std::size_t p = 0; p < seen.face.values.size(); ++p)
    view.mask.values[p] = seen.face.values[p] == MeshRaster::kNone ? 0 : 255;
  const auto displacementsOf = [&](const TriangleMesh& mesh) {
    const std::vector<CameraSet> members(mesh.positions.size(), 0);
    const std::vector<VertexMatch> matches(mesh.positions.size());
    return normalDisplacements(mesh, {&view, 1}, members, matches, {1, 2});
  };
  const std::vector<double> alone = displacementsOf(moved);
  CHECK(std::ranges::any_of(alone, [](double d) { return d != 0; }));
  for (const double before : test::kBarelyBefore)
    for (const double side : {-1.0, 1.0}) {
      INFO(before << " " << side);
      // A fold: one face is seen from the front, the other from the back.
      TriangleMesh more = moved;
      const auto first = glm::uint(more.positions.size());
      for (const glm::dvec3 at : {glm::dvec3(1, 0, -before), {1, 0.2, -1}, {2, 0.1, -0.5}, {2, 0.2, -0.1}})
        more.positions.push_back(at * glm::dvec3(side, 1, 1));
      more.triangles.push_back(glm::uvec3(0, 1, 2) + first);
      more.triangles.push_back(glm::uvec3(0, 3, 1) + first);
      const std::vector<double> both = displacementsOf(more);
      for (std::size_t v = 0; v < both.size(); ++v) CHECK(both[v] == (v < first ? alone[v] : 0.0));
    }
}

TEST_CASE("without a mask, outlines stay and their matches do not count") {
  Wall wall([](std::size_t) { return 0.05; });
  std::vector<double> found = wall.found();
  for (const double moved : found) CHECK(moved < -0.03);
  // A second wall behind each, which faces away: the border is then an outline for all three cameras.
  for (TriangleMesh* mesh : {&wall.exact, &wall.displaced}) {
    const auto n = std::uint32_t(mesh->positions.size());
    const TriangleMesh front = *mesh;
    for (std::size_t v = 0; v < n; ++v) {
      const bool border = v % 9 == 0 || v % 9 == 8 || v < 9 || v + 9 >= n;
      mesh->positions.push_back(front.positions[v] - glm::dvec3(0, 0, border ? 0 : 1));
    }
    for (const glm::uvec3& t : front.triangles) {
      glm::uvec3 back{t.x, t.z, t.y};
      for (int k = 0; k < 3; ++k)
        if (const std::uint32_t v = back[k]; !(v % 9 == 0 || v % 9 == 8 || v < 9 || v + 9 >= n)) back[k] += n;
      mesh->triangles.push_back(back);
    }
  }
  wall.members.resize(wall.displaced.positions.size(), 0);
  wall.match();
  found = wall.found();
  const auto atBorder = [](std::size_t v) { return v % 9 == 0 || v % 9 == 8 || v < 9 || v >= 72; };
  for (std::size_t v = 0; v < 81; ++v) {
    INFO(v);
    if (atBorder(v))
      CHECK(std::abs(found[v]) < 1e-3);
    else
      CHECK(found[v] < -0.03);
  }
  for (HtmView& view : wall.views) view.mask = Image8(view.picture.width, view.picture.height, 1, 255);
  found = wall.found();
  for (std::size_t v = 0; v < 81; ++v)
    if (atBorder(v)) CHECK(std::abs(found[v]) > 0.01);
}

TEST_CASE("vertices move along their normals, but no face flips") {
  const TriangleMesh grid = test::flatGrid(4);
  std::vector<double> by(grid.positions.size(), 0.25);
  TriangleMesh moved = displaced(grid, by);
  for (std::size_t v = 0; v < by.size(); ++v)
    CHECK(glm::distance(moved.positions[v], grid.positions[v]) == Approx(0.25));
  by[12] = 50;
  moved = displaced(grid, by);
  CHECK(moved.positions[12] == grid.positions[12]);
  CHECK(glm::distance(moved.positions[0], grid.positions[0]) == Approx(0.25));
  CHECK(displaced({}, {}).triangles.empty());
}

}  // namespace ibr
