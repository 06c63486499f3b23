// SPDX-License-Identifier: Apache-2.0
#include "lab/generate/synthetic.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>

#include "ibr/error.h"
#include "support/extremes.h"

using namespace ibr;

namespace {

Camera cameraAt(glm::dvec3 position, int width, int height, double fovY = 0.9, glm::dquat rotation = {1, 0, 0, 0}) {
  return {pinholeFromFov(width, height, fovY), {position, rotation}};
}

// Two planes, the nearer one tilted, and three cameras of different sizes, one of them rolled.
SyntheticOptions twoPlanes(glm::dvec3 offset = glm::dvec3(0.0)) {
  SyntheticOptions options;
  options.samplesPerAxis = 2;
  options.gridStep = 8;
  options.cameras = {
      cameraAt(offset, 160, 120), cameraAt(offset + glm::dvec3(0.5, 0.1, 0.2), 90, 140),
      cameraAt(offset + glm::dvec3(0.2, -0.4, 0), 128, 128, 1.0, glm::angleAxis(0.3, glm::dvec3(0, 0, 1)))};
  const glm::dvec3 tilted = glm::normalize(glm::dvec3(1, 0, -0.5));
  options.planes = {{offset + glm::dvec3(0, 0, -5), {1, 0, 0}, {0, 1, 0}, 40, 40, 1, 1.0},
                    {offset + glm::dvec3(0.4, 0.2, -3), tilted, {0, 1, 0}, 1.2, 1.0, 2, 0.6}};
  return options;
}

glm::dvec3 sampled(const Image8& image, glm::dvec2 pixel) {
  const double x = std::clamp(pixel.x - 0.5, 0.0, image.width - 1.001);
  const double y = std::clamp(pixel.y - 0.5, 0.0, image.height - 1.001);
  const int x0 = int(x), y0 = int(y);
  glm::dvec3 sum(0.0);
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i)
      for (int c = 0; c < 3; ++c)
        sum[c] +=
            (i ? x - x0 : 1 - (x - x0)) * (j ? y - y0 : 1 - (y - y0)) * image.pixel(x0 + i, y0 + j)[std::size_t(c)];
  return sum;
}

}  // namespace

TEST_CASE("a synthetic scene is valid and its vertices lie on the planes, near the origin and far from it") {
  const glm::dvec3 offset = GENERATE(glm::dvec3(0.0), glm::dvec3(5e5, 6e6, 100));
  const SyntheticScene made = makeScene(twoPlanes(offset));
  for (const Fault& fault : validate(made.scene)) FAIL(fault.field << " " << fault.message);
  const Cell& cell = made.scene.cells.at(0);
  REQUIRE(cell.mesh.triangles.size() > 40);
  std::size_t onPlane[2] = {0, 0};
  std::vector<int> planeOf;
  for (std::size_t p = 0; p < cell.mesh.vertexCount(); ++p) {
    const auto position = vertexPosition(made.scene, cell, p);
    REQUIRE(position);
    int nearest = -1;
    for (int i = 0; i < 2; ++i) {
      const TexturedPlane& plane = made.planes[std::size_t(i)];
      const double height = glm::dot(*position - plane.origin, glm::normalize(glm::cross(plane.u, plane.v)));
      if (std::abs(height) < 2e-6) nearest = i;
    }
    REQUIRE(nearest >= 0);
    ++onPlane[nearest];
    planeOf.push_back(nearest);
  }
  CHECK(onPlane[0] > 10);
  CHECK(onPlane[1] > 10);
  for (const glm::uvec3 t : cell.mesh.triangles)
    REQUIRE((planeOf[t.x] == planeOf[t.y] && planeOf[t.x] == planeOf[t.z]));
}

TEST_CASE("every member shows the texture at every vertex") {
  const SyntheticScene made = makeScene(twoPlanes());
  const Cell& cell = made.scene.cells.at(0);
  std::size_t looked = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Image8& photograph = made.photographs[i];
    const ImageF depth = renderDepth(made, made.scene.nodes[i].camera);
    for (std::size_t p = 0; p < cell.mesh.vertexCount(); ++p) {
      const glm::dvec3 position = *vertexPosition(made.scene, cell, p);
      const bool behind = std::abs(position.z + 5) < 1e-5;
      const TexturedPlane& plane = made.planes[behind ? 0 : 1];
      const glm::dvec3 offset = position - plane.origin;
      const glm::dvec2 at(glm::dot(offset, plane.u), glm::dot(offset, plane.v));
      const glm::dvec2 match = cell.mesh.match[i][p];
      if (match.x < 2 || match.y < 2 || match.x > photograph.width - 2 || match.y > photograph.height - 2) continue;
      bool mixed = false;  // a pixel at a silhouette shows both planes
      for (int y = int(match.y) - 2; y < int(match.y) + 2; ++y)
        for (int x = int(match.x) - 2; x < int(match.x) + 2; ++x) mixed |= (depth.pixel(x, y)[0] > 4.0f) != behind;
      if (mixed) continue;
      const glm::dvec3 difference = glm::abs(sampled(photograph, match) - textureColour(plane, at));
      REQUIRE(std::max({difference.x, difference.y, difference.z}) < 6);
      ++looked;
    }
  }
  CHECK(looked > 300);
}

TEST_CASE("the truth at a member's pose is its photograph, and depth fits the mesh") {
  const SyntheticScene made = makeScene(twoPlanes());
  CHECK(renderTruth(made, made.scene.nodes[1].camera, 2) == made.photographs[1]);
  const ImageF depth = renderDepth(made, made.scene.nodes[0].camera);
  CHECK(depth.pixel(2, 2)[0] == Approx(5.0));
  const float nearest = *std::min_element(depth.values.begin(), depth.values.end());
  CHECK(nearest < 3.0f);
  CHECK(nearest > 2.4f);
}

TEST_CASE("at infinity all cameras see the same directions") {
  SyntheticOptions options = twoPlanes();
  options.atInfinity = true;
  const SyntheticScene made = makeScene(options);
  CHECK(validate(made.scene).empty());
  const MorphMesh& mesh = made.scene.cells.at(0).mesh;
  REQUIRE(mesh.vertexCount() > 20);
  for (std::size_t p = 0; p < mesh.vertexCount(); ++p) {
    CHECK(mesh.inverseDistance[p] == 0.0f);
    const Camera& first = made.scene.nodes[0].camera;
    const glm::dvec3 ray = first.pose.rotation * unproject(first.intrinsics, mesh.match[0][p]);
    for (std::size_t i = 0; i < 3; ++i) {
      CHECK(mesh.ratio[i][p] == 1.0f);
      const Camera& camera = made.scene.nodes[i].camera;
      const glm::dvec3 other = camera.pose.rotation * unproject(camera.intrinsics, mesh.match[i][p]);
      CHECK(glm::length(ray - other) < 1e-6);
    }
  }
}

TEST_CASE("a synthetic scene may have panoramas and several cells") {
  SyntheticOptions options = twoPlanes();
  options.cameras[1].intrinsics = {CameraModel::equirectangular, 256, 128};
  options.cells = {{0, 1}, {2, 0}};
  const SyntheticScene made = makeScene(options);
  CHECK(validate(made.scene).empty());
  REQUIRE(made.scene.cells.size() == 2);
  CHECK(made.scene.cells[0].mesh.triangles.size() > 40);
  CHECK(made.scene.cells[1].mesh.triangles.size() > 40);
}

TEST_CASE("the mesh around panoramas in a room is closed, also at seams and poles") {
  const glm::dvec3 offset = GENERATE(glm::dvec3(0.0), glm::dvec3(5e5, 6e6, 100));
  SyntheticOptions options;
  for (const glm::dvec3 place : {glm::dvec3(0, 0, 0), {1, 0.1, 0}, {0.3, -0.2, 0.8}})
    options.cameras.push_back(
        {{CameraModel::equirectangular, 128, 64},
         {offset + place, glm::angleAxis(2.0 * place.x + 0.1, glm::normalize(glm::dvec3(1, 2, 3)))}});
  options.planes = roomPlanes(offset + glm::dvec3(-3, -1.5, -2.5), offset + glm::dvec3(4, 1.9, 3.5), 0.5);
  options.surfaceStep = 0.7;
  options.samplesPerAxis = 1;
  const SyntheticScene made = makeScene(options);
  for (const Fault& fault : validate(made.scene)) FAIL(fault.field << " " << fault.message);
  const Cell& cell = made.scene.cells.at(0);
  // Every undirected edge belongs to two triangles. A sphere has vertices − edges + triangles = 2.
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const glm::uvec3& t : cell.mesh.triangles)
    for (int k = 0; k < 3; ++k) ++edges[std::minmax(t[k], t[(k + 1) % 3])];
  CHECK(std::all_of(edges.begin(), edges.end(), [](const auto& edge) { return edge.second == 2; }));
  CHECK(std::ptrdiff_t(cell.mesh.vertexCount()) - std::ptrdiff_t(edges.size()) +
            std::ptrdiff_t(cell.mesh.triangles.size()) ==
        2);
  // Solid angles around each panorama add up to the sphere, and each direction is covered once.
  for (const std::uint32_t member : cell.members) {
    double sum = 0;
    for (const glm::uvec3& t : cell.mesh.triangles) {
      glm::dvec3 ray[3];
      for (int k = 0; k < 3; ++k)
        ray[k] =
            glm::normalize(*vertexPosition(made.scene, cell, t[k]) - made.scene.nodes[member].camera.pose.position);
      const double volume = glm::dot(ray[0], glm::cross(ray[1], ray[2]));
      sum += 2 * std::atan2(std::abs(volume),
                            1 + glm::dot(ray[0], ray[1]) + glm::dot(ray[1], ray[2]) + glm::dot(ray[2], ray[0]));
    }
    CHECK(sum == Approx(4 * std::numbers::pi).epsilon(1e-6));
  }
  for (std::size_t p = 0; p < cell.mesh.vertexCount(); ++p) {
    const glm::dvec3 position = *vertexPosition(made.scene, cell, p);
    double nearest = 1;
    for (const TexturedPlane& plane : made.planes)
      nearest = std::min(nearest, std::abs(glm::dot(position - plane.origin, glm::cross(plane.u, plane.v))));
    REQUIRE(nearest < 2e-6);
  }
}

TEST_CASE("surfaces that a board hides from a member are not in the mesh") {
  SyntheticOptions options;
  for (const double x : {0.0, 1.0})
    options.cameras.push_back({{CameraModel::equirectangular, 128, 64}, {{x, 0, 0}, {1, 0, 0, 0}}});
  options.planes = roomPlanes({-3, -2, -3}, {4, 2, 3}, 0.5);
  options.surfaceStep = 0.25;
  options.samplesPerAxis = 1;
  const std::size_t whole = makeScene(options).scene.cells[0].mesh.triangles.size();
  options.planes.push_back({{0.5, 0, -1.5}, {1, 0, 0}, {0, 1, 0}, 0.5, 0.5, 9, 0.5});
  const SyntheticScene made = makeScene(options);
  const std::size_t rest = made.scene.cells[0].mesh.triangles.size();
  CHECK(rest < whole);
  CHECK(rest > whole * 9 / 10);
  // Between the members, no part of the board's middle is missing.
  bool board = false;
  for (std::size_t p = 0; p < made.scene.cells[0].mesh.vertexCount(); ++p)
    board |= glm::distance(*vertexPosition(made.scene, made.scene.cells[0], p), glm::dvec3(0.5, 0, -1.5)) < 1e-6;
  CHECK(board);
}

TEST_CASE("texture values stay within range and depend on the seed") {
  TexturedPlane plane, other;
  other.seed = 2;
  double low = 255, high = 0;
  for (int i = 0; i < 5000; ++i) {
    const glm::dvec3 colour = textureColour(plane, {i * 0.0137, i * 0.0071});
    for (int c = 0; c < 3; ++c) {
      low = std::min(low, colour[c]);
      high = std::max(high, colour[c]);
    }
  }
  CHECK(low >= 10.0);
  CHECK(high <= 245.5);
  CHECK(high - low > 80);
  CHECK(textureColour(plane, {0.3, 0.4}) != textureColour(other, {0.3, 0.4}));
}

TEST_CASE("invalid options of a synthetic scene are refused") {
  SyntheticOptions options = twoPlanes();
  options.gridStep = 0;
  CHECK_THROWS_AS(makeScene(options), Error);
  options = twoPlanes();
  for (const double step : {-1.0, double(NAN), double(INFINITY), 1e-9}) {
    options.surfaceStep = step;
    CHECK_THROWS_AS(makeScene(options), Error);
  }
  options = twoPlanes();
  options.cells = {{0}};
  CHECK_THROWS_AS(makeScene(options), Error);
  options.cells = {{0, 7}};
  CHECK_THROWS_AS(makeScene(options), Error);
}

TEST_CASE("a synthetic scene with extreme options is refused, or is finite", "[N16]") {
  int refused = 0, made = 0;
  const auto attempt = [&](const SyntheticOptions& options) {
    try {
      const SyntheticScene result = makeScene(options);
      const glm::dvec3 colour = textureColour(result.planes[1], {0.3, 0.4});
      REQUIRE((colour.x >= 0 && colour.y >= 0 && colour.z >= 0));
      const MorphMesh& mesh = result.scene.cells[0].mesh;
      for (const auto& ratios : mesh.ratio)
        for (const float a : ratios) REQUIRE(std::isfinite(a));
      for (const float rho : mesh.inverseDistance) REQUIRE((std::isfinite(rho) && rho >= 0));
      ++made;
    } catch (const Error& e) {
      CHECK(e.code() == ErrorCode::invalidInput);
      ++refused;
    }
  };
  for (const double value : test::kExtremes) {
    INFO(value);
    const auto changed = [&](auto&& change) {
      SyntheticOptions options = twoPlanes();
      change(options.planes[1]);
      attempt(options);
    };
    for (int c = 0; c < 3; ++c) {
      changed([&](TexturedPlane& plane) { plane.origin[c] = value; });
      changed([&](TexturedPlane& plane) { plane.u[c] = value; });
      changed([&](TexturedPlane& plane) { plane.v[c] = value; });
    }
    for (double TexturedPlane::*field : {&TexturedPlane::extentU, &TexturedPlane::extentV, &TexturedPlane::wavelength})
      changed([&](TexturedPlane& plane) { plane.*field = value; });
    SyntheticOptions options = twoPlanes();
    options.surfaceStep = value;
    attempt(options);
  }
  CHECK(refused > 60);
  CHECK(made > 20);
}
