// SPDX-License-Identifier: Apache-2.0
// Geometry of the two morphs: the error of [T] eq. 4, and the exactness of Morph::ours.
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>

#include "ibr/frame_plan.h"
#include "reference/morph.h"
#include "render/plan/barycentric.h"
#include "render/plan/vertex.h"

using namespace ibr;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kFocal = 540 / 0.57735026918962576;  // px, for 1080 lines and 60°

double angle(glm::dvec3 a, glm::dvec3 b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

// Cameras at the given positions with exact matches of the scene points.
Scene sceneOf(const std::vector<glm::dvec3>& places, const std::vector<glm::dvec3>& points) {
  Scene scene;
  Cell cell;
  for (std::size_t i = 0; i < places.size(); ++i) {
    Node node;
    node.name = std::to_string(i);
    node.camera.intrinsics = pinholeFromFov(1920, 1080, kPi / 3);
    node.camera.pose = {places[i], glm::angleAxis(0.05 * double(i), glm::normalize(glm::dvec3(0.2, 1, 0.1)))};
    scene.nodes.push_back(node);
    cell.members.push_back(std::uint32_t(i));
    cell.mesh.match.emplace_back();
    cell.mesh.ratio.emplace_back();
  }
  for (const glm::dvec3& x : points) {
    double mean = 0;
    for (const glm::dvec3& c : places) mean += glm::distance(x, c) / double(places.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
      const Camera& camera = scene.nodes[i].camera;
      cell.mesh.match[i].push_back(
          *project(camera.intrinsics, glm::conjugate(camera.pose.rotation) * (x - camera.pose.position)));
      cell.mesh.ratio[i].push_back(float(glm::distance(x, places[i]) / mean));
    }
    cell.mesh.inverseDistance.push_back(float(1 / mean));
  }
  scene.cells.push_back(cell);
  return scene;
}

}  // namespace

TEST_CASE("the paper's morph has the errors of the table, our morph none") {
  struct Row {
    double ratio;
    std::array<double, 5> pixels;  // θ = 0, 15, 30, 45° at the midpoint; λ = 2 at θ = 30°
  };
  for (const Row& row : {Row{0.05, {0, 0.1, 0.3, 0.3, 2.1}}, Row{0.1, {0, 0.6, 1.0, 1.2, 8.6}},
                         Row{0.2, {0, 2.3, 4.0, 4.7, 35}}, Row{0.5, {0, 14, 24, 29, 183}}}) {
    const std::vector<glm::dvec3> places{{-row.ratio / 2, 0, 0}, {row.ratio / 2, 0, 0}};
    for (std::size_t column = 0; column < 5; ++column) {
      const double theta = std::array{0, 15, 30, 45, 30}[column] * kPi / 180, lambda = column == 4 ? 2.0 : 0.5;
      const glm::dvec3 x(std::sin(theta), 0, -std::cos(theta)), eye = (1 - lambda) * places[0] + lambda * places[1];
      const Scene scene = sceneOf(places, {x});
      const Barycentric b = barycentric(places, eye);
      const glm::dvec3 paper = reference::morph(scene, scene.cells[0], 0, b.free, Morph::paper, eye);
      const glm::dvec3 ours = reference::morph(scene, scene.cells[0], 0, b.clamped, Morph::ours, eye);
      INFO("b/d " << row.ratio << ", column " << column);
      CHECK(kFocal * angle(paper, x - eye) == Approx(row.pixels[column]).margin(0.06).epsilon(0.07));
      CHECK(kFocal * angle(ours, x - eye) < 1e-3);
    }
  }
}

TEST_CASE("our morph is exact inside, outside and off the span of lines, triangles and tetrahedra") {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(-1, 1);
  const std::vector<glm::dvec3> all{{0, 0, 0}, {1, 0.1, 0}, {0.3, 0.9, 0.2}, {0.4, 0.2, -0.8}};
  for (std::size_t d : {2u, 3u, 4u}) {
    const std::vector<glm::dvec3> places(all.begin(), all.begin() + std::ptrdiff_t(d));
    std::vector<glm::dvec3> points;
    for (int i = 0; i < 20; ++i) points.emplace_back(4 * unit(random), 2 * unit(random), -4 - 30 * (unit(random) + 1));
    const Scene scene = sceneOf(places, points);
    for (int repeat = 0; repeat < 50; ++repeat) {
      const glm::dvec3 eye = places[0] + 1.5 * glm::dvec3(unit(random), unit(random), unit(random));
      const Barycentric b = barycentric(places, eye);
      for (std::size_t p = 0; p < points.size(); ++p) {
        const glm::dvec3 seen = reference::morph(scene, scene.cells[0], p, b.clamped, Morph::ours, eye);
        CHECK(kFocal * angle(seen, points[p] - eye) < 5e-3);
      }
    }
  }
}

TEST_CASE("at a member's pose the morph returns its own rays for any ratio and depth") {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<float> factor(0.3f, 3.0f);
  const std::vector<glm::dvec3> places{{0, 0, 0}, {1, 0.1, 0}, {0.3, 0.9, 0.2}};
  Scene scene = sceneOf(places, {{0.5, 0.3, -3}, {1, -1, -20}});
  for (auto& member : scene.cells[0].mesh.ratio)
    for (float& a : member) a *= factor(random);
  for (float& rho : scene.cells[0].mesh.inverseDistance) rho *= factor(random);
  for (std::size_t i = 0; i < places.size(); ++i)
    for (std::size_t p = 0; p < 2; ++p) {
      const Camera& camera = scene.nodes[i].camera;
      const Barycentric b = barycentric(places, places[i]);
      const glm::dvec3 ray = camera.pose.rotation * unproject(camera.intrinsics, scene.cells[0].mesh.match[i][p]);
      CHECK(kFocal * angle(reference::morph(scene, scene.cells[0], p, b.clamped, Morph::ours, places[i]), ray) < 1e-9);
      CHECK(kFocal * angle(reference::morph(scene, scene.cells[0], p, b.free, Morph::paper, places[i]), ray) < 1e-9);
    }
}

TEST_CASE("sums of directions in float are accurate up to 120° of spread (N6)", "[N6][T10]") {
  const glm::vec3 a(0, 0, -1);
  for (double degrees : {0.0, 1e-6, 60.0, 90.0, 120.0, 150.0, 179.0})
    for (double lambda : {0.0, 0.5, 1.0, -2.0, 3.0}) {
      const double theta = degrees * kPi / 180;
      const glm::dvec3 exactB(std::sin(theta), 0, -std::cos(theta));
      const glm::vec3 b(exactB);
      const glm::vec3 sum = float(1 - lambda) * a + float(lambda) * b;
      const glm::dvec3 exact = (1 - lambda) * glm::dvec3(a) + lambda * exactB;
      INFO(degrees << "° at λ = " << lambda);
      const double magnitude = std::abs(1 - lambda) + std::abs(lambda);
      CHECK(angle(glm::dvec3(sum), exact) <= 4e-7 * magnitude / glm::length(exact));
      if (degrees <= 120 && lambda >= 0 && lambda <= 1) CHECK(glm::length(exact) >= 0.5 - 1e-12);
    }
}

TEST_CASE("only triangles whose rays differ by more than 120° are left out", "[N6][T10]") {
  for (const double degrees : {0.0, 1e-6, 60.0, 90.0, 119.99, 120.01, 150.0, 179.0, 179.99, 180.0}) {
    const double half = degrees * kPi / 360;  // two cameras see a point from both sides
    const glm::dvec3 x(0, 0, -std::cos(half));
    Scene scene;
    for (const double side : {-1.0, 1.0}) {
      const glm::dvec3 place(side * std::sin(half), 0, 0);
      Camera camera{pinholeFromFov(1920, 1080, kPi / 3), {place, {}}};
      const double turn = std::atan2(place.x - x.x, place.z - x.z);  // the camera looks at the point
      camera.pose.rotation = glm::angleAxis(turn, glm::dvec3(0, 1, 0));
      scene.nodes.push_back({"", camera, "", ""});
    }
    Cell cell;
    cell.members = {0, 1};
    cell.mesh.match = {{{960, 540}}, {{960, 540}}};
    cell.mesh.ratio = {{1}, {1}};
    INFO(degrees);
    CHECK(angle(scene.nodes[0].camera.pose.rotation * glm::dvec3(0, 0, -1),
                scene.nodes[1].camera.pose.rotation * glm::dvec3(0, 0, -1)) == Approx(2 * half).margin(1e-9));
    CHECK(raysAgree(scene, cell, 0) == (degrees < 120));
  }
}
