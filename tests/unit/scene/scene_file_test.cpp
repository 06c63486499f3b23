// SPDX-License-Identifier: Apache-2.0
// Saving and loading a scene preserves the scene.
#include <catch2/catch.hpp>
#include <clocale>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <random>

#include "base/file.h"
#include "ibr/error.h"
#include "ibr/memory_demand.h"
#include "ibr/scene.h"
#include "ibr/texture.h"
#include "image/depth_texture.h"
#include "scene/mesh_buffer.h"
#include "scene/scene_file.h"
#include "support/error_of.h"
#include "support/temporary_folder.h"

namespace fs = std::filesystem;
using namespace ibr;

namespace {

// Scene far from the origin, with several camera models and sizes. Cells have two to four members, rejected triangles
// and points at infinity; one cell has no triangles and one has no points.
Scene example(std::uint64_t seed = 1) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  Scene scene;
  for (int n = 0; n < 5; ++n) {
    Node node;
    node.name = "photo " + std::to_string(n) + ".jpg";
    node.imageFile = "images/photo " + std::to_string(n) + ".jpg";
    node.textureFile = "textures/" + std::to_string(n) + ".ktx2";
    node.camera.intrinsics = {CameraModel::pinhole, 640 + n, 480, 500.25 + n, 501.125, 320.0625, 239.5};
    node.camera.pose.position = glm::dvec3(5e5, 4.2e6, 120) + glm::dvec3(unit(random), unit(random), unit(random));
    node.camera.pose.rotation =
        glm::normalize(glm::dquat(1, 0.1 * unit(random), 0.1 * unit(random), 0.1 * unit(random)));
    scene.nodes.push_back(node);
  }
  scene.nodes[1].gain = {0.125, 1 / 3.0, 4096};
  scene.nodes[2].capture = {1.0 / 320, 2.8, 100, 3.61, 20, "DJI", "P\"2", "built in"};
  scene.nodes[3].depthFile = "depth/photo 3.jpg.ktx2";
  scene.nodes[3].depthScale = 1 / 3.0;
  scene.nodes[4].camera.intrinsics = {CameraModel::equirectangular, 2048, 1024, 0, 0, 0, 0};
  const auto cell = [&](std::vector<std::uint32_t> members, std::size_t points) {
    Cell c;
    c.members = std::move(members);
    for (const std::uint32_t m : c.members) {
      const Intrinsics& k = scene.nodes[m].camera.intrinsics;
      std::vector<glm::vec2> match;
      std::vector<float> ratio;
      for (std::size_t p = 0; p < points; ++p) {
        match.emplace_back(quantisedMatch(float(unit(random) * k.width), k.width),
                           quantisedMatch(float(unit(random) * k.height), k.height));
        ratio.push_back(float(0.5 + unit(random)));
      }
      c.mesh.match.push_back(match);
      c.mesh.ratio.push_back(ratio);
    }
    for (std::size_t p = 0; p < points; ++p) {
      c.mesh.inverseDistance.push_back(p % 7 == 0 ? 0.0f : float(unit(random)));
      c.mesh.uncertainty.push_back(float(unit(random)));
    }
    if (points == 40 || points == 50)
      for (std::size_t p = 0; p < points; ++p) c.mesh.planes.emplace_back(p % 3, p % 3 ? 7 : 0, p % 3 ? 65535 : 0, 0);
    for (std::size_t t = 0; points > 2 && t < 2 * points; ++t) {
      c.mesh.triangles.emplace_back(t % points, (t + 1) % points, (t + 2) % points);
      c.mesh.tier.push_back(t < points ? kTierConsistent : kTierRejected);
      c.mesh.ecc.push_back(float(2 * unit(random) - 1));
    }
    c.quality.coverage = unit(random);
    return c;
  };
  scene.cells = {cell({0, 1}, 40), cell({2, 0, 1}, 50), cell({0, 1, 2, 3}, 66000), cell({3, 4}, 2), cell({1, 2}, 0)};
  scene.cells[1].quality.ecc = 0.9;
  scene.cells[1].quality.score = 0.25;
  scene.unusedPhotographs = {{"somewhere/else.jpg", "its axis is 47° from that of any other"}, {"b", "\"quoted\""}};
  scene.cells[0].mesh.tier.assign(scene.cells[0].mesh.triangles.size(), kTierRejected);  // no triangle of tier 0
  scene.backdrops = {cell({2}, 30)};
  for (MorphMesh* mesh : {&scene.backdrops[0].mesh, &scene.cells[1].mesh})
    for (std::size_t p = 0; p < mesh->vertexCount(); ++p) {
      mesh->confirmations.push_back(std::uint8_t(p == 0 ? 255 : p % 11));
      mesh->consensus.push_back(float(unit(random)));
    }
  scene.acquisition = "unordered";
  scene.settings = R"({"seed":1,"theta":26.5})";
  scene.origin = GeographicOrigin{49.45, 11.08, 309.5};
  return scene;
}

void compareMeshes(const MorphMesh& a, const MorphMesh& b) {
  CHECK(a.match == b.match);
  CHECK(a.ratio == b.ratio);
  CHECK(a.inverseDistance == b.inverseDistance);
  CHECK(a.uncertainty == b.uncertainty);
  CHECK(a.triangles == b.triangles);
  CHECK(a.tier == b.tier);
  CHECK(a.ecc == b.ecc);
  CHECK(a.planes == b.planes);
  CHECK(a.confirmations == b.confirmations);
  CHECK(a.consensus == b.consensus);
}

void compare(const Scene& a, const Scene& b) {
  REQUIRE(a.nodes.size() == b.nodes.size());
  for (std::size_t n = 0; n < a.nodes.size(); ++n) {
    CHECK(a.nodes[n].name == b.nodes[n].name);
    CHECK(a.nodes[n].imageFile == b.nodes[n].imageFile);
    CHECK(a.nodes[n].textureFile == b.nodes[n].textureFile);
    CHECK(a.nodes[n].depthFile == b.nodes[n].depthFile);
    CHECK(a.nodes[n].depthScale == b.nodes[n].depthScale);
    CHECK(a.nodes[n].camera.intrinsics == b.nodes[n].camera.intrinsics);
    CHECK(a.nodes[n].camera.pose.position == b.nodes[n].camera.pose.position);
    CHECK(glm::length(a.nodes[n].camera.pose.rotation - b.nodes[n].camera.pose.rotation) < 1e-15);
    CHECK(a.nodes[n].gain == b.nodes[n].gain);
    CHECK((a.nodes[n].capture == b.nodes[n].capture));
  }
  REQUIRE(a.cells.size() == b.cells.size());
  for (std::size_t c = 0; c < a.cells.size(); ++c) {
    INFO("cell " << c);
    CHECK(a.cells[c].members == b.cells[c].members);
    compareMeshes(a.cells[c].mesh, b.cells[c].mesh);
    CHECK(a.cells[c].quality.coverage == b.cells[c].quality.coverage);
    CHECK(std::isnan(a.cells[c].quality.score) == std::isnan(b.cells[c].quality.score));
    if (!std::isnan(a.cells[c].quality.score)) CHECK(a.cells[c].quality.score == b.cells[c].quality.score);
    CHECK(std::isnan(a.cells[c].quality.ecc) == std::isnan(b.cells[c].quality.ecc));
  }
  REQUIRE(a.backdrops.size() == b.backdrops.size());
  for (std::size_t c = 0; c < a.backdrops.size(); ++c) compareMeshes(a.backdrops[c].mesh, b.backdrops[c].mesh);
  CHECK(a.acquisition == b.acquisition);
  CHECK(a.settings == b.settings);
  REQUIRE(a.unusedPhotographs.size() == b.unusedPhotographs.size());
  for (std::size_t i = 0; i < a.unusedPhotographs.size(); ++i) {
    CHECK(a.unusedPhotographs[i].name == b.unusedPhotographs[i].name);
    CHECK(a.unusedPhotographs[i].reason == b.unusedPhotographs[i].reason);
  }
  REQUIRE(a.origin.has_value() == b.origin.has_value());
  if (a.origin) CHECK(a.origin->longitudeDegrees == b.origin->longitudeDegrees);
}

}  // namespace

TEST_CASE("a saved scene loads unchanged") {
  const test::TemporaryFolder folder;
  const Scene scene = example();
  REQUIRE(validate(scene).empty());
  saveScene(scene, folder / "scene");
  compare(loadScene(folder / "scene"), scene);
  compare(loadScene(folder / "scene/scene.gltf"), scene);
  CHECK(loadScene(folder / "scene").folder == folder / "scene");
}

TEST_CASE("an empty scene loads unchanged") {
  const test::TemporaryFolder folder;
  saveScene(Scene{}, folder.path());
  compare(loadScene(folder.path()), Scene{});
}

TEST_CASE("saving a loaded scene writes the same bytes and removes stale files", "[P3]") {
  const test::TemporaryFolder folder;
  saveScene(example(), folder / "a");
  saveScene(example(2), folder / "b");
  saveScene(loadScene(folder / "a"), folder / "b");
  std::size_t files = 0;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder / "b"))
    if (entry.is_regular_file()) {
      ++files;
      const bool same = readFile(entry.path()) == readFile(folder / "a" / fs::relative(entry.path(), folder / "b"));
      INFO(entry.path());
      CHECK(same);
    }
  CHECK(files == 1 + 5);  // scene.gltf and five buffers: a cell without points needs no buffer
}

TEST_CASE("a locale with decimal commas changes no file") {
  const test::TemporaryFolder folder;
  saveScene(example(), folder / "a");
  const char* const set = std::setlocale(LC_ALL, "de_DE.UTF-8");
  saveScene(example(), folder / "b");
  compare(loadScene(folder / "a"), example());
  if (set) std::setlocale(LC_ALL, "C");
  CHECK(readTextFile(folder / "a/scene.gltf") == readTextFile(folder / "b/scene.gltf"));
}

TEST_CASE("a scene that is not valid is not saved") {
  const test::TemporaryFolder folder;
  Scene scene = example();
  scene.cells[1].mesh.ratio[2][17] = -1;
  CHECK_THROWS_WITH(saveScene(scene, folder / "scene"), Catch::Contains("cells[1].mesh.ratio[2][17]"));
  CHECK_FALSE(fs::exists(folder / "scene/scene.gltf"));
}

TEST_CASE("a mesh is decoded unchanged from its buffer") {
  const Scene scene = example();
  for (const Cell& cell : scene.cells) {
    std::vector<glm::ivec2> sizes;
    for (const std::uint32_t m : cell.members)
      sizes.emplace_back(scene.nodes[m].camera.intrinsics.width, scene.nodes[m].camera.intrinsics.height);
    std::vector<std::byte> bytes = encodeMesh(scene, cell);
    compareMeshes(decodeMesh(bytes, layoutOf(cell.mesh), sizes), cell.mesh);
    bytes.resize(bytes.size() + 4);
    CHECK_THROWS_AS(decodeMesh(bytes, layoutOf(cell.mesh), sizes), Error);
  }
}

TEST_CASE("a scene of version 1 is refused, and the error names the remedy") {
  const test::TemporaryFolder folder;
  saveScene(example(), folder.path());
  std::string text = readTextFile(folder / "scene.gltf");
  const std::string current = "\"version\": 2,";
  const std::size_t at = text.find(current);
  REQUIRE(at != std::string::npos);
  text.replace(at, current.size(), "\"version\": 1,");
  writeFile(folder / "scene.gltf", text);
  const Error error = test::errorOf([&] { loadScene(folder.path()); });
  CHECK(error.code() == ErrorCode::invalidInput);
  CHECK_THAT(error.what(), Catch::Contains((folder / "scene.gltf").string()) &&
                               Catch::Contains("/extensions/IBR_image_graph/version") &&
                               Catch::Contains("`ibr build`"));
}

TEST_CASE("the memory demand includes all bytes of depth textures") {
  const test::TemporaryFolder folder;
  Scene scene = example();
  scene.folder = folder.path();
  CHECK_THROWS_AS(depthTextureBytes(scene), Error);
  std::filesystem::create_directories(folder / "depth");
  writeKtx2(folder / scene.nodes[3].depthFile,
            depthTexture({ImageF(160, 120, 1, 0.5f), ImageF(160, 120, 1, 0.5f)}, 643).texture);
  CHECK(depthTextureBytes(scene) == 160 * 120 * 4);
  const std::vector<TextureFormat> formats(scene.nodes.size(), TextureFormat::rgba8);
  const MemoryDemand without = memoryDemand(scene, formats), with = memoryDemand(scene, formats, 76800);
  CHECK(with.depth == 76800);
  CHECK(with.sum() == without.sum() + 76800);
}

TEST_CASE("matches keep their grid in texture coordinates of any image size") {
  std::mt19937_64 random(3);
  for (const int side : {1, 3, 480, 641, 1567, 16383, 16384, 30001, 65536}) {
    const double grid = side <= 16384 ? 512 : 128;
    for (int repeat = 0; repeat < 2000; ++repeat) {
      const double pixel = double(random() % std::uint64_t(double(side) * grid + 1)) / grid;
      REQUIRE(matchFromTexture(textureCoordinate(float(pixel), side), side) == float(pixel));
      const float odd = float(double(side) * double(random() >> 11) * 0x1p-53);
      CHECK(std::abs(matchFromTexture(textureCoordinate(odd, side), side) - odd) <= 0.5 / grid);
    }
  }
}

TEST_CASE("file names are encoded as URIs and decoded unchanged") {
  for (const char* name : {"images/a b.jpg", "images/ä%20#?.png", "a..b/c+d&e.jpg", "100%.jpg"})
    CHECK(decodeUri(encodeUri(name)) == name);
  CHECK(encodeUri("a b%.jpg") == "a%20b%25.jpg");
  for (const char* wrong :
       {"", "/etc/passwd", "file:///x", "http://x/y", "data:image/png;base64,AA", "a%2", "a%zz", "C:\\x", "a%00b"})
    CHECK(decodeUri(wrong).empty());
}
