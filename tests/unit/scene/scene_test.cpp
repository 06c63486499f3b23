// SPDX-License-Identifier: Apache-2.0
#include "ibr/scene.h"

#include <catch2/catch.hpp>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>

#include "lab/generate/synthetic.h"

using namespace ibr;

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();

Scene goodScene() {
  SyntheticOptions options;
  for (double x : {0.0, 0.4, 0.8}) options.cameras.push_back({pinholeFromFov(64, 48, 1.0), {{x, 0, 0}, {1, 0, 0, 0}}});
  options.planes = {{.origin = {0, 0, -3}, .extentU = 20, .extentV = 20, .wavelength = 0.5}};
  options.gridStep = 12;
  options.samplesPerAxis = 1;
  options.cells = {{0, 1, 2}, {0, 1}};
  Scene scene = makeScene(options).scene;
  Cell backdrop;
  backdrop.members = {2};
  backdrop.mesh.match = {{{0, 0}, {64, 0}, {0, 48}}};
  backdrop.mesh.ratio = {{1, 1, 1}};
  backdrop.mesh.inverseDistance = {0.3f, 0.3f, 0.0f};
  backdrop.mesh.uncertainty = {0, 0, 0};
  backdrop.mesh.triangles = {{0, 1, 2}};
  backdrop.mesh.tier = {kTierConsistent};
  backdrop.mesh.ecc = {1};
  scene.backdrops = {backdrop};
  return scene;
}

std::vector<glm::u16vec4>& planesOf(Scene& scene) {
  MorphMesh& mesh = scene.cells[0].mesh;
  mesh.planes.assign(mesh.vertexCount(), glm::u16vec4(1, 2, 0, 0));
  return mesh.planes;
}

MorphMesh& evidenceOf(MorphMesh& mesh) {
  mesh.confirmations.assign(mesh.vertexCount(), 3);
  mesh.consensus.assign(mesh.vertexCount(), 0.5f);
  return mesh;
}

void setDepth(Node& node, double scale) {
  node.depthFile = "depth/1.ktx2";
  node.depthScale = scale;
}

}  // namespace

TEST_CASE("validation reports each fault of a scene with its field", "[P2]") {
  REQUIRE(validate(goodScene()).empty());
  const std::vector<std::pair<const char*, std::function<void(Scene&)>>> faults{
      {"nodes[1].name", [](Scene& s) { s.nodes[1].name.clear(); }},
      {"nodes[1].name", [](Scene& s) { s.nodes[1].name = s.nodes[0].name; }},
      {"nodes[0].camera.intrinsics", [](Scene& s) { s.nodes[0].camera.intrinsics.width = 0; }},
      {"nodes[0].camera.intrinsics", [](Scene& s) { s.nodes[0].camera.intrinsics.height = 65537; }},
      {"nodes[2].camera.intrinsics", [](Scene& s) { s.nodes[2].camera.intrinsics.fx = 0; }},
      {"nodes[2].camera.intrinsics", [](Scene& s) { s.nodes[2].camera.intrinsics.fy = -1; }},
      {"nodes[2].camera.intrinsics", [](Scene& s) { s.nodes[2].camera.intrinsics.fy = kInfinity; }},
      {"nodes[2].camera.intrinsics", [](Scene& s) { s.nodes[2].camera.intrinsics.cx = kNan; }},
      {"nodes[0].camera.pose.position", [](Scene& s) { s.nodes[0].camera.pose.position.z = kNan; }},
      {"nodes[0].camera.pose.position", [](Scene& s) { s.nodes[0].camera.pose.position.x = -kInfinity; }},
      {"nodes[0].camera.pose.rotation",
       [](Scene& s) {
         s.nodes[0].camera.pose.rotation = {0, 0, 0, 0};
       }},
      {"nodes[0].camera.pose.rotation",
       [](Scene& s) {
         s.nodes[0].camera.pose.rotation = {1.002, 0, 0, 0};
       }},
      {"nodes[0].camera.pose.rotation", [](Scene& s) { s.nodes[0].camera.pose.rotation.x = kNan; }},
      {"cells[0].members", [](Scene& s) { s.cells[0].members = {0}; }},
      {"cells[0].members",
       [](Scene& s) {
         s.cells[0].members = {0, 1, 2, 3, 4};
       }},
      {"cells[1].members[1]", [](Scene& s) { s.cells[1].members[1] = 3; }},
      {"cells[0].members[2]", [](Scene& s) { s.cells[0].members[2] = 0; }},
      {"cells[0].mesh.match", [](Scene& s) { s.cells[0].mesh.match.pop_back(); }},
      {"cells[0].mesh.ratio", [](Scene& s) { s.cells[0].mesh.ratio.emplace_back(); }},
      {"cells[0].mesh.match[1]", [](Scene& s) { s.cells[0].mesh.match[1].pop_back(); }},
      {"cells[0].mesh.match[2][3]", [](Scene& s) { s.cells[0].mesh.match[2][3].y = kNan; }},
      {"cells[0].mesh.ratio[0]", [](Scene& s) { s.cells[0].mesh.ratio[0].push_back(1); }},
      {"cells[0].mesh.ratio[0][5]", [](Scene& s) { s.cells[0].mesh.ratio[0][5] = 0; }},
      {"cells[0].mesh.ratio[0][5]", [](Scene& s) { s.cells[0].mesh.ratio[0][5] = kInfinity; }},
      {"cells[0].mesh.inverseDistance[2]", [](Scene& s) { s.cells[0].mesh.inverseDistance[2] = -0.1f; }},
      {"cells[0].mesh.inverseDistance[2]", [](Scene& s) { s.cells[0].mesh.inverseDistance[2] = kNan; }},
      {"cells[0].mesh.uncertainty", [](Scene& s) { s.cells[0].mesh.uncertainty.clear(); }},
      {"cells[0].mesh.uncertainty[1]", [](Scene& s) { s.cells[0].mesh.uncertainty[1] = kInfinity; }},
      {"cells[0].mesh.triangles[4]", [](Scene& s) { s.cells[0].mesh.triangles[4].y = 1000; }},
      {"cells[0].mesh.planes",
       [](Scene& s) {
         s.cells[0].mesh.planes = {{1, 2, 0, 0}};
       }},
      {"cells[0].mesh.planes[1]",
       [](Scene& s) {
         planesOf(s)[1] = {2, 2, 0, 0};
       }},
      {"cells[0].mesh.planes[1]",
       [](Scene& s) {
         planesOf(s)[1] = {3, 2, 0, 0};
       }},
      {"cells[0].mesh.planes[1]",
       [](Scene& s) {
         planesOf(s)[1] = {1, 0, 2, 0};
       }},
      {"cells[0].mesh.planes[1]",
       [](Scene& s) {
         planesOf(s)[1] = {0, 1, 0, 0};
       }},
      {"cells[0].mesh.confirmations", [](Scene& s) { evidenceOf(s.cells[0].mesh).confirmations.pop_back(); }},
      {"cells[0].mesh.confirmations", [](Scene& s) { evidenceOf(s.cells[0].mesh).confirmations.clear(); }},
      {"cells[0].mesh.consensus", [](Scene& s) { evidenceOf(s.cells[0].mesh).consensus.clear(); }},
      {"cells[0].mesh.consensus[1]", [](Scene& s) { evidenceOf(s.cells[0].mesh).consensus[1] = 1.01f; }},
      {"cells[0].mesh.consensus[1]", [](Scene& s) { evidenceOf(s.cells[0].mesh).consensus[1] = kNan; }},
      {"backdrops[0].mesh.consensus[2]", [](Scene& s) { evidenceOf(s.backdrops[0].mesh).consensus[2] = -0.5f; }},
      {"nodes[1].depthScale", [](Scene& s) { s.nodes[1].depthFile = "depth/1.ktx2"; }},
      {"nodes[1].depthScale", [](Scene& s) { s.nodes[1].depthScale = 2; }},
      {"nodes[1].depthScale", [](Scene& s) { setDepth(s.nodes[1], -1); }},
      {"nodes[1].depthScale", [](Scene& s) { setDepth(s.nodes[1], kInfinity); }},
      {"nodes[1].depthScale", [](Scene& s) { setDepth(s.nodes[1], kNan); }},
      {"cells[0].mesh.tier", [](Scene& s) { s.cells[0].mesh.tier.pop_back(); }},
      {"cells[0].mesh.tier[0]", [](Scene& s) { s.cells[0].mesh.tier[0] = 2; }},
      {"cells[0].mesh.tier[1]", [](Scene& s) { s.cells[0].mesh.tier[0] = kTierRejected; }},
      {"cells[0].mesh.ecc", [](Scene& s) { s.cells[0].mesh.ecc.push_back(0); }},
      {"cells[0].mesh.ecc[1]", [](Scene& s) { s.cells[0].mesh.ecc[1] = 1.01f; }},
      {"cells[0].mesh.ecc[1]", [](Scene& s) { s.cells[0].mesh.ecc[1] = kNan; }},
      {"cells[0].quality.coverage", [](Scene& s) { s.cells[0].quality.coverage = -0.01; }},
      {"cells[0].quality.coverage", [](Scene& s) { s.cells[0].quality.coverage = 1.01; }},
      {"cells[0].quality.ecc", [](Scene& s) { s.cells[0].quality.ecc = -1.01; }},
      {"cells[1].quality.ecc", [](Scene& s) { s.cells[1].quality.ecc = kInfinity; }},
      {"cells[0].quality.residualPx", [](Scene& s) { s.cells[0].quality.residualPx = -1; }},
      {"nodes[1].gain[2]", [](Scene& s) { s.nodes[1].gain.b = 0; }},
      {"nodes[1].gain[0]", [](Scene& s) { s.nodes[1].gain.r = std::nan(""); }},
      {"nodes[0].capture.iso", [](Scene& s) { s.nodes[0].capture.iso = -1; }},
      {"cells[0].quality.score", [](Scene& s) { s.cells[0].quality.score = 1.01; }},
      {"backdrops[0].quality.coverage", [](Scene& s) { s.backdrops[0].quality.coverage = 2; }},
      {"backdrops[0].members",
       [](Scene& s) {
         s.backdrops[0].members = {0, 1};
       }},
      {"backdrops[0].members", [](Scene& s) { s.backdrops[0].members.clear(); }},
      {"backdrops[1].members[0]", [](Scene& s) { s.backdrops.push_back(s.backdrops[0]); }},
      {"backdrops[0].mesh.ratio[0][1]", [](Scene& s) { s.backdrops[0].mesh.ratio[0][1] = -1; }},
  };
  for (const auto& [field, spoil] : faults) {
    Scene scene = goodScene();
    spoil(scene);
    const std::vector<Fault> found = validate(scene);
    INFO(field);
    REQUIRE_FALSE(found.empty());
    CHECK(found[0].field == field);
    CHECK_FALSE(found[0].message.empty());
  }
}

TEST_CASE("a scene with evidence and depth textures is valid") {
  Scene scene = goodScene();
  evidenceOf(scene.cells[0].mesh).consensus[1] = 1;
  evidenceOf(scene.backdrops[0].mesh).consensus[1] = 0;
  setDepth(scene.nodes[1], 0.25);
  CHECK(validate(scene).empty());
}

TEST_CASE("validation reports all faults in order, up to the limit") {
  Scene scene = goodScene();
  for (Node& node : scene.nodes) node.camera.intrinsics.fx = 0;
  scene.cells[1].mesh.ratio[0][0] = 0;
  const std::vector<Fault> all = validate(scene);
  REQUIRE(all.size() == 4);
  CHECK(all[0].field == "nodes[0].camera.intrinsics");
  CHECK(all[3].field == "cells[1].mesh.ratio[0][0]");
  CHECK(validate(scene, 2).size() == 2);
}

TEST_CASE("empty scenes and cells without triangles are valid") {
  CHECK(validate(Scene{}).empty());
  Scene scene = goodScene();
  scene.cells[0].mesh.triangles.clear();
  scene.cells[0].mesh.tier.clear();
  scene.cells[0].mesh.ecc.clear();
  scene.nodes[2].camera.intrinsics = {CameraModel::equirectangular, 64, 32};
  CHECK(validate(scene).empty());
}

TEST_CASE("a vertex lies where its rays meet, or has no position") {
  Scene scene = goodScene();
  Cell& cell = scene.cells[0];
  for (std::size_t p = 0; p < cell.mesh.vertexCount(); ++p) {
    const auto position = vertexPosition(scene, cell, p);
    REQUIRE(position);
    CHECK(position->z == Approx(-3).epsilon(1e-6));
    for (std::size_t i = 0; i < 3; ++i) {
      const Camera& camera = scene.nodes[cell.members[i]].camera;
      const auto pixel = project(camera.intrinsics, *position - camera.pose.position);
      CHECK(glm::distance(*pixel, glm::dvec2(cell.mesh.match[i][p])) < 1e-4);
    }
  }
  // Only the products of ratio and distance count.
  const glm::dvec3 before = *vertexPosition(scene, cell, 1);
  for (auto& ratio : cell.mesh.ratio) ratio[1] *= 0.25f;
  cell.mesh.inverseDistance[1] *= 0.25f;
  CHECK(*vertexPosition(scene, cell, 1) == before);
  for (float wrong : {0.0f, -1.0f, kNan}) {
    cell.mesh.inverseDistance[0] = wrong;
    CHECK_FALSE(vertexPosition(scene, cell, 0));
  }
  cell.mesh.inverseDistance[0] = std::numeric_limits<float>::denorm_min();
  CHECK(vertexPosition(scene, cell, 0));
  for (float wrong : {kNan, kInfinity}) {
    cell.mesh.ratio[1][0] = wrong;
    CHECK_FALSE(vertexPosition(scene, cell, 0));
  }
}

TEST_CASE("triangles of tier 0 are counted") {
  Scene scene = goodScene();
  MorphMesh& mesh = scene.cells[0].mesh;
  CHECK(mesh.tier0Count() == mesh.triangles.size());
  mesh.tier.back() = kTierRejected;
  CHECK(mesh.tier0Count() == mesh.triangles.size() - 1);
  CHECK(MorphMesh().tier0Count() == 0);
}
