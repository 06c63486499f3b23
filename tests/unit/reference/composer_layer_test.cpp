// SPDX-License-Identifier: Apache-2.0
// Rasterisation of photographs' meshes into a view by the reference implementation.
#include "reference/composer_layer.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

using namespace ibr;
using ibr::reference::Candidate;
using ibr::reference::Hypothesis;
using ibr::reference::HypothesisMesh;

namespace {

constexpr int kSide = 40;

Camera cameraAt(glm::dvec3 position, glm::dquat rotation = {1, 0, 0, 0}) {
  return {pinholeFromFov(kSide, kSide, 1.0), {position, rotation}};
}

Candidate candidateAt(const Camera& camera) {
  Candidate candidate;
  candidate.camera = camera;
  return candidate;
}

using Vertex = HypothesisMesh::Vertex;

// Returns a point of the world as a vertex of a photograph at the origin that looks along −z.
Vertex at(glm::dvec3 point, double trust = 1, double consensus = 0.9) {
  return {point, 1.0, trust, consensus};
}

HypothesisMesh quad(const std::array<Vertex, 4>& corners) {
  return {{corners.begin(), corners.end()}, {{0, 1, 2}, {0, 2, 3}}};
}

const Hypothesis& pixel(const std::vector<Hypothesis>& layer, int x, int y) {
  return layer[std::size_t(y * kSide + x)];
}

std::size_t covered(const std::vector<Hypothesis>& layer) {
  return std::size_t(std::ranges::count_if(layer, [](const Hypothesis& h) { return h.trust > 0; }));
}

}  // namespace

TEST_CASE("a layer interpolates with perspective correction") {
  // A floor from z = −1 to z = −9; trust falls with the distance.
  const HypothesisMesh floor = quad(
      {at({-9, -1, -1}, 1, 0.9), at({9, -1, -1}, 1, 0.9), at({9, -1, -9}, 0.25, 0.1), at({-9, -1, -9}, 0.25, 0.1)});
  const Camera view = cameraAt({0.3, 0.5, 0.2}, glm::angleAxis(-0.3, glm::dvec3(1, 0, 0)));
  const std::vector<Hypothesis> layer = reference::drawLayer(view, candidateAt(cameraAt({0, 0, 0})), floor);
  std::size_t compared = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const Hypothesis& here = pixel(layer, x, y);
      if (!(here.trust > 0)) continue;
      const glm::dvec3 own = unproject(view.intrinsics, {x + 0.5, y + 0.5}), ray = view.pose.rotation * own;
      const double along = -1.5 / ray.y, z = 0.2 + along * ray.z;  // the floor is 1.5 units below the view
      CHECK(here.inverseDepth == Approx(1 / (along * -own.z)));
      const double share = (-1 - z) / 8;
      CHECK(here.trust == Approx(1 - 0.75 * share));
      CHECK(here.consensus == Approx(0.9 - 0.8 * share));
      ++compared;
    }
  CHECK(compared > 500);
}

TEST_CASE("triangles that reach behind the camera are drawn in front of it") {
  const HypothesisMesh floor = quad({at({-20, -1, 30}), at({20, -1, 30}), at({20, -1, -900}), at({-20, -1, -900})});
  const std::vector<Hypothesis> layer =
      reference::drawLayer(cameraAt({0, 0, 0}), candidateAt(cameraAt({0, 0, 0})), floor);
  CHECK(pixel(layer, 20, kSide - 1).trust == 1);
  CHECK(pixel(layer, 0, kSide - 1).trust == 1);
  CHECK(pixel(layer, 20, 10).trust == 0);
  const Camera away = cameraAt({0, 0, 40}, glm::angleAxis(3.14159265358979, glm::dvec3(0, 1, 0)));
  CHECK(covered(reference::drawLayer(away, candidateAt(cameraAt({0, 0, 0})), floor)) == 0);
}

TEST_CASE("the nearest surface wins in any order, and a surface at infinity is drawn") {
  HypothesisMesh mesh = quad({at({-9, -9, -5}), at({9, -9, -5}), at({9, 9, -5}), at({-9, 9, -5})});
  for (Vertex corner : {at({-0.5, -0.5, -2}), at({0.5, -0.5, -2}), at({0.5, 0.5, -2})}) mesh.vertices.push_back(corner);
  for (std::size_t p = 0; p < 4; ++p) {
    Vertex corner = mesh.vertices[p];
    corner.inverseDepth = 0;
    mesh.vertices.push_back(corner);
  }
  mesh.triangles.push_back({4, 5, 6});
  mesh.triangles.push_back({7, 8, 9});
  mesh.triangles.push_back({7, 9, 10});
  const Candidate candidate = candidateAt(cameraAt({0, 0, 0}));
  const auto draw = [&] { return reference::drawLayer(cameraAt({0, 0, 0}), candidate, mesh); };
  for (int turn = 0; turn < 5; ++turn) {
    const std::vector<Hypothesis> layer = draw();
    CHECK(pixel(layer, 21, 23).inverseDepth == Approx(0.5));
    CHECK(pixel(layer, 5, 5).inverseDepth == Approx(0.2));
    std::ranges::rotate(mesh.triangles, mesh.triangles.begin() + 1);
  }
  std::erase_if(mesh.triangles, [](const glm::uvec3& t) { return t.x < 7; });
  const std::vector<Hypothesis> far = draw();
  CHECK(covered(far) == kSide * kSide);
  CHECK(std::ranges::all_of(far, [](const Hypothesis& h) { return h.inverseDepth == 0 && h.trust == 1; }));
}

TEST_CASE("triangles of tier 0 of a backdrop are hypotheses, trusted by confirmations") {
  const Intrinsics k = pinholeFromFov(kSide, kSide, 1.0);
  MorphMesh mesh;
  mesh.match = {{{0, 0}, {40, 0}, {40, 40}, {0, 40}, {20, 20}}};
  mesh.ratio = {{1, 1, 1, 1, 2}};
  mesh.inverseDistance = {0.1f, 0.1f, 0.1f, 0.1f, 0.5f};
  mesh.confirmations = {0, 1, 2, 3, 9};
  mesh.consensus = {0.1f, 0.2f, 0.3f, 0.4f, 0.5f};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.tier = {kTierConsistent, kTierRejected};
  const HypothesisMesh made = reference::hypothesisMesh(k, mesh);
  REQUIRE(made.triangles.size() == 1);
  CHECK(made.triangles[0] == glm::uvec3(0, 1, 2));
  const std::array trust{0.06, 0.25, 0.7, 1.0, 1.0};
  for (std::size_t p = 0; p < 5; ++p) {
    CHECK(made.vertices[p].trust == trust[p]);
    CHECK(made.vertices[p].consensus == double(mesh.consensus[p]));
    CHECK(made.vertices[p].inverseDepth == double(mesh.inverseDistance[p]));
  }
  CHECK(glm::distance(made.vertices[4].point, glm::dvec3(0, 0, -2)) < 1e-12);
}

TEST_CASE("the mesh of a depth map is cut where depth jumps by more than two steps") {
  reference::PhotographDepth depth{ImageF(4, 3, 1, 0.5f), Image8(4, 3, 1, 2), ImageF(4, 3, 1, 0.4f), 0.01, 0};
  const Intrinsics k = pinholeFromFov(kSide, kSide, 1.0);
  const auto triangles = [&] { return reference::hypothesisMesh(k, depth).triangles.size(); };
  CHECK(triangles() == 12);
  for (int y = 0; y < 3; ++y) depth.inverseDepth.pixel(3, y)[0] = 0.519f;
  CHECK(triangles() == 12);
  for (int y = 0; y < 3; ++y) depth.inverseDepth.pixel(3, y)[0] = 0.521f;
  CHECK(triangles() == 8);
  const HypothesisMesh mesh = reference::hypothesisMesh(k, depth);
  CHECK(mesh.vertices[5].trust == 0.7);
  CHECK(mesh.vertices[5].point.z == -1);
  const auto seen = project(k, mesh.vertices[5].point);  // pixel (1, 1) of the depth map
  REQUIRE(seen);
  CHECK(seen->x == Approx(1.5 / 4 * kSide));
  CHECK(seen->y == Approx(1.5 / 3 * kSide));
}
