// SPDX-License-Identifier: Apache-2.0
#include "lab/generate/moving_figure.h"

#include <catch2/catch.hpp>
#include <glm/gtc/quaternion.hpp>

#include "support/test_meshes.h"

namespace ibr {
namespace {

TEST_CASE("the moving figure is closed, oriented outward, periodic and free of jumps") {
  const TexturedMesh first = movingFigure(0, 1);
  CHECK(test::isOrientedManifold(first.mesh));
  CHECK(test::borderEdges(first.mesh) == 0);
  CHECK(test::eulerNumber(first.mesh) == 2 * 4);
  CHECK(first.textureAt.size() == first.mesh.triangles.size());
  CHECK(first.textureOf.size() == first.mesh.triangles.size());
  CHECK(movingFigure(1, 1).mesh == first.mesh);
  CHECK(movingFigure(-3, 1).mesh == first.mesh);
  double furthest = 0, moved = 0;
  for (int k = 0; k < 50; ++k) {
    const TriangleMesh now = movingFigure(k / 50.0, 1).mesh, then = movingFigure((k + 1) / 50.0, 1).mesh;
    CHECK(now.triangles == first.mesh.triangles);
    double volume = 0;
    for (const glm::uvec3& t : now.triangles)
      volume += glm::dot(now.positions[t.x], glm::cross(now.positions[t.y], now.positions[t.z])) / 6;
    CHECK(volume > 0.15);
    for (std::size_t v = 0; v < now.positions.size(); ++v) {
      furthest = std::max(furthest, glm::distance(now.positions[v], then.positions[v]));
      moved = std::max(moved, glm::distance(now.positions[v], first.mesh.positions[v]));
    }
  }
  CHECK(furthest < 0.2);
  CHECK(moved > 0.3);
}

TEST_CASE("the inexact mesh has the requested error") {
  const TriangleMesh exact = movingFigure(0.3, 1).mesh, inexact = inexactMesh(exact, 0.004, 0.3, 7);
  CHECK(inexact.triangles == exact.triangles);
  double sum = 0;
  for (std::size_t v = 0; v < exact.positions.size(); ++v) {
    const glm::dvec3 d = inexact.positions[v] - exact.positions[v];
    sum += glm::dot(d, d);
    CHECK(glm::length(d) <= 0.004 * 4 * (1 + 1e-9));  // eight waves in phase
  }
  CHECK(std::sqrt(sum / double(exact.positions.size())) == Approx(0.004).epsilon(0.15));
  CHECK(inexactMesh(exact, 0.004, 0.3, 7) == inexact);
  CHECK(inexactMesh(exact, 0.004, 0.4, 7) != inexact);
  CHECK(inexactMesh(exact, 0, 0.3, 7) == exact);
}

// A tilted rectangle as a mesh, and a camera that looks at the rectangle.
struct Rectangle {
  TexturedPlane plane{{0.1, -0.2, -3}, glm::normalize(glm::dvec3(1, 0, 0.5)), {0, 1, 0}, 1.5, 1.2, 5, 0.2};
  TexturedMesh mesh;
  Camera camera{pinholeFromFov(80, 60, 0.9), {{0.05, 0, 0}, glm::angleAxis(0.1, glm::dvec3(0, 0, 1))}};
  Rectangle() {
    const auto corner = [&](double u, double v) {
      mesh.mesh.positions.push_back(plane.origin + u * plane.u + v * plane.v);
      return glm::dvec2(u, v);
    };
    const double u = plane.extentU / 2, v = plane.extentV / 2;
    const glm::dvec2 a = corner(-u, -v), b = corner(u, -v), c = corner(u, v), d = corner(-u, v);
    mesh.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.textureAt = {{a, b, c}, {a, c, d}};
    mesh.textureOf = {0, 0};
    mesh.textures = {plane};
  }
};

TEST_CASE("the photograph of a rectangle equals that of its plane") {
  const Rectangle r;
  const MeshPhotograph picture = photograph(r.mesh, r.camera, 2);
  SyntheticScene scene;
  scene.planes = {r.plane};
  const Image8 truth = renderTruth(scene, r.camera, 2);
  std::size_t inside = 0, partly = 0;
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 80; ++x) {
      const int mask = picture.mask.pixel(x, y)[0];
      inside += mask == 255;
      partly += mask > 0 && mask < 255;
      for (std::size_t c = 0; c < 3; ++c) {
        const double share = mask / 255.0, expected = truth.pixel(x, y)[c] + 60 * (1 - share);
        CHECK(std::abs(picture.colours.pixel(x, y)[c] - expected) <= 1.01);
      }
    }
  CHECK(inside > 600);
  CHECK(partly > 50);
}

TEST_CASE("near surfaces hide far ones, and nothing behind the camera is drawn") {
  Rectangle r;
  const Image8 alone = photograph(r.mesh, r.camera, 1).colours;
  const auto first = std::uint32_t(r.mesh.mesh.positions.size());
  for (std::uint32_t v = 0; v < first; ++v)
    r.mesh.mesh.positions.push_back(r.mesh.mesh.positions[v] - glm::dvec3(0, 0, 1));
  for (int f = 0; f < 2; ++f) {
    r.mesh.mesh.triangles.push_back(r.mesh.mesh.triangles[std::size_t(f)] + first);
    r.mesh.textureAt.push_back(r.mesh.textureAt[std::size_t(f)]);
    r.mesh.textureOf.push_back(1);
  }
  r.mesh.textures.push_back(r.plane);
  r.mesh.textures.back().seed = 9;
  const MeshPhotograph both = photograph(r.mesh, r.camera, 1);
  const Image8 mask = photograph(Rectangle().mesh, r.camera, 1).mask;
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 80; ++x)
      if (mask.pixel(x, y)[0] == 255)
        for (std::size_t c = 0; c < 3; ++c) CHECK(both.colours.pixel(x, y)[c] == alone.pixel(x, y)[c]);
  Camera away = r.camera;
  away.pose.rotation = glm::angleAxis(3.14159, glm::dvec3(0, 1, 0));
  CHECK(photograph(r.mesh, away, 1).mask == Image8(80, 60, 1));
}

}  // namespace
}  // namespace ibr
