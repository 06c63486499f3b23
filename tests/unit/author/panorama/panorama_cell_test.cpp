// SPDX-License-Identifier: Apache-2.0
#include "author/panorama/panorama_cell.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <numbers>
#include <random>

#include "author/cgal/delaunay.h"
#include "author/panorama/panorama_faces.h"
#include "ibr/metrics.h"
#include "lab/generate/synthetic.h"

using namespace ibr;

namespace {

constexpr double kPi = std::numbers::pi;
const glm::dvec3 kLow(-2.5, -1.6, -3.5), kHigh(3.6, 1.9, 2.2);

SyntheticScene room(std::vector<Camera> cameras, int samplesPerAxis = 2) {
  SyntheticOptions options;
  options.cameras = std::move(cameras);
  options.planes = roomPlanes(kLow, kHigh, 0.25, 7);
  options.surfaceStep = 1;
  options.samplesPerAxis = samplesPerAxis;
  return makeScene(options);
}

Camera panorama(glm::dvec3 position, double yaw, double tilt, int width = 512) {
  Camera camera;
  camera.intrinsics.model = CameraModel::equirectangular;
  camera.intrinsics.width = width;
  camera.intrinsics.height = width / 2;
  camera.pose = {position, glm::angleAxis(yaw, glm::dvec3(0, 1, 0)) * glm::angleAxis(tilt, glm::dvec3(1, 0, 0))};
  return camera;
}

std::vector<Camera> triangleOfPanoramas() {
  return {panorama({0, 0, 0}, 0.3, 0.02), panorama({0.6, 0, 0}, -2.0, -0.03), panorama({0.3, 0.05, -0.5}, 3.1, 0.0)};
}

double distanceToWalls(glm::dvec3 p) {
  double nearest = INFINITY;
  for (int c = 0; c < 3; ++c) nearest = std::min({nearest, std::abs(p[c] - kLow[c]), std::abs(p[c] - kHigh[c])});
  return nearest;
}

std::vector<glm::dvec3> randomDirections(std::size_t count, unsigned seed) {
  std::mt19937 engine(seed);
  const auto uniform = [&] { return 2.0 * double(engine()) / 4294967295.0 - 1.0; };
  std::vector<glm::dvec3> directions;
  while (directions.size() < count) {
    const glm::dvec3 d(uniform(), uniform(), uniform());
    if (const double length = glm::length(d); length > 0.1 && length < 1) directions.push_back(d);
  }
  return directions;
}

}  // namespace

TEST_CASE("the six cube faces look along the axes, upright, and cover all directions") {
  std::vector<glm::dvec3> axes;
  for (const glm::dquat turn : cubeRotations()) {
    axes.push_back(glm::round(turn * glm::dvec3(0, 0, -1)));
    CHECK(glm::distance(axes.back(), turn * glm::dvec3(0, 0, -1)) < 1e-12);
    if (axes.back().y == 0) CHECK((turn * glm::dvec3(0, 1, 0)).y == Approx(1));
  }
  for (const glm::dvec3 axis : {glm::dvec3(1, 0, 0), {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}})
    CHECK(std::count(axes.begin(), axes.end(), axis) == 1);
  CHECK(faceSize(2048, kPi / 2) == 652);  // a quarter of the equator; the stretch at the centre of a face is 4/π
  CHECK(faceSize(1, 1.0) == 1);
}

TEST_CASE("a face equals the image of a pinhole at the panorama's centre, across the seam and over the poles") {
  const Camera camera = panorama({0.2, 0.1, -0.3}, 1.0, 0.2, 1024);
  const SyntheticScene scene = room({camera, panorama({0.9, 0, 0}, 0, 0, 64)}, 3);
  for (const glm::dquat turn : cubeRotations()) {
    const Intrinsics face = faceIntrinsics(200, 110 * kPi / 180);
    const Image8 picture = PanoramaSampler(scene.photographs[0]).view(face, turn);
    const Image8 truth = renderTruth(scene, {face, {camera.pose.position, camera.pose.rotation * turn}}, 3);
    const Difference off = difference(picture, truth, 40);
    INFO("largest " << off.largest);
    CHECK(psnr(picture, truth) > 32);
    CHECK(off.shareAbove < 1e-3);
  }
}

TEST_CASE("the Delaunay triangulation of the sphere is closed, faces outwards and has empty circles", "[N10]") {
  const std::vector<glm::dvec3> directions = randomDirections(300, 5);
  const std::vector<glm::uvec3> triangles = delaunaySphere(directions);
  REQUIRE(triangles.size() == 2 * directions.size() - 4);  // Euler's formula for a sphere
  for (const glm::uvec3& t : triangles) {
    const glm::dvec3 a = glm::normalize(directions[t.x]), b = glm::normalize(directions[t.y]),
                     c = glm::normalize(directions[t.z]);
    REQUIRE(glm::determinant(glm::dmat3(a, b, c)) > 0);
    const glm::dvec3 axis = glm::normalize(glm::cross(b - a, c - a));
    for (const glm::dvec3 d : directions) REQUIRE(glm::dot(axis, glm::normalize(d)) < glm::dot(axis, a) + 1e-12);
  }
  std::vector<glm::dvec3> doubled = directions;
  doubled.insert(doubled.end(), directions.begin(), directions.end());
  CHECK(delaunaySphere(doubled) == triangles);
}

TEST_CASE("too few directions have no triangles, and half a sphere is not closed", "[N10]") {
  CHECK(delaunaySphere({}).empty());
  CHECK(delaunaySphere(std::vector<glm::dvec3>{{1, 0, 0}}).empty());
  CHECK(delaunaySphere(std::vector<glm::dvec3>{{1, 0, 0}, {0, 1, 0}}).empty());
  std::vector<glm::dvec3> half = randomDirections(100, 9);
  for (glm::dvec3& d : half) d.z = -std::abs(d.z) - 0.05;
  for (const glm::uvec3& t : delaunaySphere(half)) {
    const glm::dvec3 middle = glm::normalize(half[t.x]) + glm::normalize(half[t.y]) + glm::normalize(half[t.z]);
    CHECK(middle.z < 0);
  }
}

TEST_CASE("panoramas in a room are matched on its walls, in all directions") {
  const std::vector<Camera> cameras = triangleOfPanoramas();
  const SyntheticScene synthetic = room(cameras);
  std::vector<PanoramaView> views;
  for (std::size_t i = 0; i < cameras.size(); ++i) views.push_back({cameras[i], synthetic.photographs[i]});
  const bool known = GENERATE(false, true);
  std::vector<glm::dvec3> points;
  if (known)
    for (int i = 0; i < 40; ++i) points.emplace_back(-2 + 0.13 * i, i % 2 ? -1.6 : 1.9, -3 + 0.1 * i);
  const CellMesh cell = makePanoramaCell(views, points);
  Scene scene;
  for (std::size_t i = 0; i < cameras.size(); ++i) scene.nodes.push_back({std::to_string(i), cameras[i], {}, {}});
  scene.cells.push_back({{0, 1, 2}, cell.mesh, cell.quality});
  for (const Fault& fault : validate(scene)) FAIL_CHECK(fault.field << " " << fault.message);

  CHECK(cell.quality.coverage > 0.85);
  CHECK(cell.quality.coverage < 1.0 + 1e-9);
  CHECK(cell.quality.residualPx < 0.2);
  // No triangle folds over in any member, including at the seam and at the poles.
  for (std::size_t t = 0; t < cell.mesh.tier0Count(); ++t)
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      glm::dmat3 rays;
      for (int k = 0; k < 3; ++k)
        rays[k] = unproject(cameras[i].intrinsics, glm::dvec2(cell.mesh.match[i][cell.mesh.triangles[t][k]]));
      REQUIRE(glm::determinant(rays) > 0);
    }
  std::size_t good = 0;
  for (std::size_t p = 0; p < cell.mesh.vertexCount(); ++p) {
    const auto position = vertexPosition(scene, scene.cells[0], p);
    good += position && distanceToWalls(*position) < 0.03 * glm::length(*position);
  }
  CHECK(double(good) > 0.9 * double(cell.mesh.vertexCount()));
}

TEST_CASE("panoramas are not matched where they are masked") {
  const std::vector<Camera> cameras = triangleOfPanoramas();
  const SyntheticScene synthetic = room(cameras);
  std::vector<PanoramaView> views;
  for (std::size_t i = 0; i < cameras.size(); ++i) views.push_back({cameras[i], synthetic.photographs[i], {}});
  const auto agreeingIn = [&](const CellMesh& cell) {  // agreeing triangles in the masked band of the first panorama
    std::size_t agreeing = 0;
    const int width = views[0].picture.width;
    for (std::size_t t = 0; t < cell.mesh.tier0Count(); ++t) {
      const auto& m = cell.mesh.match[0];
      const glm::uvec3 v = cell.mesh.triangles[t];
      agreeing += std::ranges::all_of(std::array{v.x, v.y, v.z}, [&](unsigned p) {
        return m[p].x > 0.3f * float(width) && m[p].x < 0.45f * float(width);
      });
    }
    return agreeing;
  };
  REQUIRE(agreeingIn(makePanoramaCell(views, {})) > 20);
  Image8 band(views[0].picture.width, views[0].picture.height, 1, 255);
  for (int y = 0; y < band.height; ++y)
    for (int x = band.width / 4; x < band.width / 2; ++x) band.pixel(x, y)[0] = 0;
  views[0].mask = band;
  CHECK(agreeingIn(makePanoramaCell(views, {})) > 10);  // the other two panoramas agree
  views[1].mask = Image8(band.width, band.height, 1, 0);
  CHECK(agreeingIn(makePanoramaCell(views, {})) == 0);
}

TEST_CASE("the sphere is closed for cocircular, nearly equal and many polar directions", "[N10]") {
  const auto closes = [](const std::vector<glm::dvec3>& directions, const std::vector<glm::uvec3>& triangles) {
    double solidAngle = 0;
    std::vector<bool> used(directions.size());
    for (const glm::uvec3& t : triangles) {
      const glm::dvec3 a = glm::normalize(directions[t.x]), b = glm::normalize(directions[t.y]),
                       c = glm::normalize(directions[t.z]);
      // Van Oosterom and Strackee 1983; the angle is negative for a triangle that faces inwards.
      solidAngle +=
          2 * std::atan2(glm::determinant(glm::dmat3(a, b, c)), 1 + glm::dot(a, b) + glm::dot(b, c) + glm::dot(c, a));
      used[t.x] = used[t.y] = used[t.z] = true;
    }
    CHECK(solidAngle == Approx(4 * kPi).epsilon(1e-9));
    const auto vertices = std::size_t(std::count(used.begin(), used.end(), true));
    CHECK(triangles.size() == 2 * vertices - 4);
    return vertices;
  };
  std::vector<glm::dvec3> cube;
  for (int i = 0; i < 8; ++i) cube.emplace_back(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
  CHECK(closes(cube, delaunaySphere(cube)) == 8);
  std::vector<glm::dvec3> poles = cube;
  for (int i = 0; i < 36; ++i) poles.emplace_back(0, i % 2 ? 1 : -1, 0);
  CHECK(closes(poles, delaunaySphere(poles)) == 10);
  std::vector<glm::dvec3> close = randomDirections(60, 3);
  for (int i = 0; i < 60; ++i) close.push_back(close[std::size_t(i)] + glm::dvec3(1e-9, -1e-9, 1e-9));
  CHECK(closes(close, delaunaySphere(close)) >= 60);
}
