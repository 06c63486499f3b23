// SPDX-License-Identifier: Apache-2.0
#include "example_scene.h"

#include <utility>

#include "ibr/texture.h"
#include "image/depth_texture.h"
#include "io/image_file.h"
#include "lab/generate/synthetic.h"

namespace fs = std::filesystem;

namespace ibr::test {
namespace {

SyntheticScene plainScene() {
  const glm::dvec3 offset(5e5, 5.4e6, 300);  // typical of UTM coordinates
  SyntheticOptions options;
  const auto add = [&](glm::dvec3 position, int width, int height, double roll) {
    options.cameras.push_back(
        {pinholeFromFov(width, height, 1.0), {offset + position, glm::angleAxis(roll, glm::dvec3(0, 0, 1))}});
  };
  add({0, 0, 0}, 96, 64, 0);
  add({0.5, 0, 0.1}, 64, 96, 0.1);
  add({0.2, 0.4, 0}, 80, 80, -0.2);
  add({0.2, 0.1, 0.6}, 100, 75, 0);
  options.cameras[1].intrinsics.cx += 3.25;
  options.cameras.push_back(
      {{CameraModel::equirectangular, 128, 64}, {offset + glm::dvec3(0.3, 0, 0.3), {1, 0, 0, 0}}});
  options.planes = {{offset + glm::dvec3(0, 0, -4), {1, 0, 0}, {0, 1, 0}, 30, 30, 1, 0.8}};
  options.cells = {{0, 1}, {2, 0, 1}, {0, 1, 2, 3}, {3, 4}};
  options.gridStep = 8;
  options.samplesPerAxis = 1;
  return makeScene(options);
}

void addTroubles(MorphMesh& mesh) {
  const std::size_t agreeing = mesh.triangles.size() * 2 / 3;
  for (std::size_t t = agreeing; t < mesh.triangles.size(); ++t) {
    mesh.tier[t] = kTierRejected;
    mesh.ecc[t] = -0.25f;
  }
  for (std::size_t p = 0; p < mesh.vertexCount(); p += 5) {
    mesh.inverseDistance[p] = 0;
    mesh.uncertainty[p] = 0.01f;
    for (auto& ratio : mesh.ratio) ratio[p] = 1;
  }
  mesh.planes.assign(mesh.vertexCount(), glm::u16vec4(1, 3, 0, 0));
}

// A backdrop of a whole photograph, 4 units away.
Cell backdropOf(const Scene& scene, std::uint32_t node) {
  const Intrinsics& k = scene.nodes[node].camera.intrinsics;
  Cell cell;
  cell.members = {node};
  cell.mesh.match = {{{0, 0}, {k.width, 0}, {0, k.height}, {k.width, k.height}}};
  cell.mesh.ratio = {{1, 1, 1, 1}};
  cell.mesh.inverseDistance = {0.25f, 0.25f, 0.25f, 0.25f};
  cell.mesh.uncertainty = {0.1f, 0.1f, 0.1f, 0.1f};
  cell.mesh.triangles = {{0, 2, 1}, {1, 2, 3}};
  cell.mesh.tier = {kTierConsistent, kTierConsistent};
  cell.mesh.ecc = {1, 1};
  cell.mesh.confirmations = {0, 1, 2, 255};
  cell.mesh.consensus = {0.1f, 0.25f, 0.75f, 1};
  return cell;
}

Scene withTroubles(Scene scene) {
  addTroubles(scene.cells[0].mesh);
  addTroubles(scene.cells[2].mesh);
  scene.cells[1].quality.coverage = 0.75;
  scene.cells[1].quality.ecc = 0.5;
  scene.cells[1].quality.score = 0.25;
  scene.nodes[1].gain = {0.5, 1.25, 2};
  scene.nodes[1].capture = {.exposureTime = 0.004, .fNumber = 2.8, .iso = 100, .model = "M1"};
  scene.unusedPhotographs = {{"left.jpg", "it is the only photograph"}};
  Cell pointsOnly = scene.cells[3];
  pointsOnly.members = {4, 3};
  std::swap(pointsOnly.mesh.match[0], pointsOnly.mesh.match[1]);
  std::swap(pointsOnly.mesh.ratio[0], pointsOnly.mesh.ratio[1]);
  pointsOnly.mesh.triangles.clear();
  pointsOnly.mesh.tier.clear();
  pointsOnly.mesh.ecc.clear();
  scene.cells.push_back(pointsOnly);
  Cell empty;
  empty.members = {1, 2};
  empty.mesh.match.resize(2);
  empty.mesh.ratio.resize(2);
  scene.cells.push_back(empty);
  scene.backdrops = {backdropOf(scene, 0)};
  scene.nodes[1].maskFile = "masks/view1.png";
  scene.nodes[0].depthFile = "depth/view0.ktx2";
  scene.nodes[0].depthScale = 0.25;
  scene.settings = R"({"dimension":2,"seed":1})";
  scene.origin = GeographicOrigin{49.45, 11.08, 309.5};
  return scene;
}

}  // namespace

Scene exampleScene() {
  return withTroubles(plainScene().scene);
}

void writeExampleScene(const fs::path& folder) {
  const SyntheticScene made = plainScene();
  const Scene scene = withTroubles(made.scene);
  fs::create_directories(folder / "images");
  fs::create_directories(folder / "textures");
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    writeImage(folder / scene.nodes[n].imageFile, made.photographs[n]);
    writeKtx2(folder / scene.nodes[n].textureFile, buildMips(made.photographs[n]));
  }
  fs::create_directories(folder / "masks");
  writeImage(folder / scene.nodes[1].maskFile, Image8(64, 96, 1, 255));
  fs::create_directories(folder / "depth");
  writeKtx2(folder / scene.nodes[0].depthFile,
            depthTexture({ImageF(24, 16, 1, float(scene.nodes[0].depthScale)), ImageF(24, 16, 1, 0.5f)}, 96).texture);
  saveScene(scene, folder);
}

}  // namespace ibr::test
