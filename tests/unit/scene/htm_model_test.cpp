// SPDX-License-Identifier: Apache-2.0
#include "ibr/htm_model.h"

#include <catch2/catch.hpp>
#include <glm/common.hpp>
#include <limits>

#include "base/file.h"
#include "ibr/asset.h"
#include "support/contents_below.h"
#include "support/error_of.h"
#include "support/temporary_folder.h"
#include "support/test_meshes.h"

namespace ibr {
namespace {

HtmModel model(std::size_t cameras = 3, const TriangleMesh& mesh = test::cube({1e5, -2e6, 30})) {
  HtmModel model;
  for (std::size_t i = 0; i < cameras; ++i) {
    HtmCamera camera;
    camera.name = "cam" + std::to_string(i) + ".jpg";
    camera.camera.intrinsics = {CameraModel::pinhole, 640, 480, 500.0 + double(i), 501, 320.25, 239};
    camera.camera.pose.position = {double(i), 2, 0.1};
    camera.camera.pose.rotation = glm::normalize(glm::dquat(1, 0.1 * double(i), 0.2, 0));
    camera.imageFile = "images/" + camera.name;
    if (i % 2) camera.visibilityFile = "visibility/ä " + std::to_string(i) + ".png";
    model.cameras.push_back(camera);
  }
  model.surface.mesh = mesh;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    model.surface.members.push_back((CameraSet(v) * 0x9e3779b97f4a7c15) >> (64 - cameras));
  for (std::size_t k = 0; k < cameras * cameras * mesh.positions.size(); ++k)
    model.complements.emplace_back(0.1f * float(k), -1e-30f * float(k));
  model.settings = R"({"alpha":0.3})";
  return model;
}

void expectFault(const HtmModel& wrong, const std::string& field) {
  const std::vector<Fault> faults = validate(wrong);
  REQUIRE(faults.size() == 1);
  CHECK(faults[0].field == field);
  CHECK_FALSE(faults[0].message.empty());
  test::TemporaryFolder folder;
  const Error error = test::errorOf([&] { saveHtmModel(wrong, folder.path()); });
  CHECK(error.code() == ErrorCode::invalidInput);
  CHECK_THAT(error.what(), Catch::Contains(field));
  CHECK(test::contentsBelow(folder.path()).empty());
}

TEST_CASE("a valid model has no faults") {
  CHECK(validate(model()).empty());
  CHECK(validate(model(1)).empty());
  CHECK(validate(model(kMaxHtmCameraCount)).empty());
  HtmModel plain = model();
  plain.complements.clear();
  plain.source = plain.surface;
  CHECK(validate(plain).empty());
}

TEST_CASE("each fault of a model is reported with its field") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto with = [](auto&& change) {
    HtmModel wrong = model();
    change(wrong);
    return wrong;
  };
  expectFault(with([](HtmModel& m) { m.cameras[1].name = ""; }), "cameras[1].name");
  expectFault(with([](HtmModel& m) { m.cameras[2].name = m.cameras[0].name; }), "cameras[2].name");
  expectFault(with([](HtmModel& m) {
                m.cameras[0].camera.intrinsics = {CameraModel::equirectangular, 64, 32};
              }),
              "cameras[0].camera.intrinsics");
  expectFault(with([](HtmModel& m) {
                m.cameras[0].given = m.cameras[0].camera;
                m.cameras[0].given->intrinsics.width += 1;
              }),
              "cameras[0].given.intrinsics");
  expectFault(with([&](HtmModel& m) { m.surface.mesh.positions[3].y = nan; }), "surface.mesh.positions[3]");
  expectFault(with([](HtmModel& m) { m.surface.mesh.triangles[5].z = 8; }), "surface.mesh.triangles[5]");
  expectFault(with([](HtmModel& m) { m.surface.members.pop_back(); }), "surface.members");
  expectFault(with([](HtmModel& m) { m.surface.members[4] = 8; }), "surface.members[4]");
  expectFault(with([](HtmModel& m) { m.complements.pop_back(); }), "complements");
  expectFault(with([&](HtmModel& m) { m.complements[7].y = float(nan); }), "complements[7]");
  expectFault(with([](HtmModel& m) {
                m.source = m.surface;
                m.source->mesh.triangles[0].x = 99;
              }),
              "source.mesh.triangles[0]");
  HtmModel none;
  CHECK(validate(none).at(0).field == "cameras");
  HtmModel many = model(kMaxHtmCameraCount);
  many.cameras.push_back(many.cameras[0]);
  many.cameras.back().name = "one more";
  many.complements.clear();
  expectFault(many, "cameras");
  HtmModel broken = model();
  for (glm::dvec3& p : broken.surface.mesh.positions) p.x = nan;
  CHECK(validate(broken, 3).size() == 3);
}

void expectSame(const HtmModel& a, const HtmModel& b, double tolerance) {
  REQUIRE(a.cameras.size() == b.cameras.size());
  for (std::size_t i = 0; i < a.cameras.size(); ++i) {
    CHECK(a.cameras[i].name == b.cameras[i].name);
    CHECK(a.cameras[i].camera.intrinsics.fx == b.cameras[i].camera.intrinsics.fx);
    CHECK(a.cameras[i].camera.intrinsics.cx == b.cameras[i].camera.intrinsics.cx);
    CHECK(a.cameras[i].camera.pose.position == b.cameras[i].camera.pose.position);
    CHECK(a.cameras[i].camera.pose.rotation == b.cameras[i].camera.pose.rotation);
    CHECK(a.cameras[i].imageFile == b.cameras[i].imageFile);
    CHECK(a.cameras[i].visibilityFile == b.cameras[i].visibilityFile);
    REQUIRE(a.cameras[i].given.has_value() == b.cameras[i].given.has_value());
    if (!a.cameras[i].given) continue;
    CHECK(a.cameras[i].given->intrinsics == b.cameras[i].given->intrinsics);
    CHECK(a.cameras[i].given->pose.position == b.cameras[i].given->pose.position);
    CHECK(a.cameras[i].given->pose.rotation == b.cameras[i].given->pose.rotation);
  }
  const auto same = [&](const HtmSurface& x, const HtmSurface& y) {
    CHECK(x.mesh.triangles == y.mesh.triangles);
    CHECK(x.members == y.members);
    REQUIRE(x.mesh.positions.size() == y.mesh.positions.size());
    for (std::size_t v = 0; v < x.mesh.positions.size(); ++v)
      CHECK(glm::distance(x.mesh.positions[v], y.mesh.positions[v]) <= tolerance);
  };
  same(a.surface, b.surface);
  REQUIRE(a.source.has_value() == b.source.has_value());
  if (a.source) same(*a.source, *b.source);
  CHECK(a.complements == b.complements);
  CHECK(a.settings == b.settings);
}

TEST_CASE("a saved model loads unchanged, and saving again writes the same bytes") {
  TriangleMesh sphere = test::sphere(20);
  for (glm::dvec3& p : sphere.positions) p = 0.7 * p + glm::dvec3(4e5, 5e6, 300);
  std::vector<HtmModel> models{model(), model(64), model(1), model(4, sphere)};
  models[0].source = HtmSurface{sphere, std::vector<CameraSet>(sphere.positions.size(), 5)};
  models[0].cameras[1].given = models[0].cameras[1].camera;
  models[0].cameras[1].given->intrinsics.fx += 3;
  models[0].cameras[1].given->pose.position.y -= 0.25;
  models[1].complements.clear();
  models[2].settings.clear();
  for (const HtmModel& made : models) {
    test::TemporaryFolder folder;
    saveHtmModel(made, folder.path());
    const HtmModel loaded = loadHtmModel(folder.path());
    CHECK(loaded.folder == folder.path());
    expectSame(made, loaded, 2e-7);
    for (const glm::dvec3& p : loaded.surface.mesh.positions)
      CHECK(glm::round(p * 0x1p22) == p * 0x1p22);  // positions are rounded to 2⁻²²; extents are between 1 and 2
    const auto before = test::contentsBelow(folder.path());
    saveHtmModel(loaded, folder.path());
    CHECK(test::contentsBelow(folder.path()) == before);
    expectSame(loadHtmModel(folder / "model.gltf"), loaded, 0);
  }
}

TEST_CASE("models of many vertices have 32-bit indices") {
  const TriangleMesh grid = test::flatGrid(260);
  HtmModel large = model(1, grid);
  large.complements.clear();
  test::TemporaryFolder folder;
  saveHtmModel(large, folder.path());
  CHECK(loadHtmModel(folder.path()).surface.mesh == grid);
}

TEST_CASE("saving again removes stale buffers and no other files") {
  test::TemporaryFolder folder;
  HtmModel first = model();
  first.source = first.surface;
  saveHtmModel(first, folder.path());
  CHECK(test::contentsBelow(folder.path()).size() == 4);
  for (const char* other : {"notes.txt", "scan.bin", "scan-0123456789abcdef.txt", "scan-0123456789abcdeg.bin",
                            "scan_0123456789abcdef.bin", "0123456789abcdef.bin"})
    writeFile(folder / "meshes" / other, "kept");
  HtmModel second = model(2, test::flatGrid(2));
  second.complements.clear();
  saveHtmModel(second, folder.path());
  const auto contents = test::contentsBelow(folder.path());
  CHECK(contents.size() == 8);
  CHECK(contents.contains("meshes/notes.txt"));
}

TEST_CASE("models with invalid texts, paths or surfaces are not saved") {
  const auto refused = [](auto&& change, const char* why) {
    HtmModel wrong = model();
    change(wrong);
    test::TemporaryFolder folder;
    const Error error = test::errorOf([&] { saveHtmModel(wrong, folder.path()); });
    CHECK(error.code() == ErrorCode::invalidInput);
    CHECK_THAT(error.what(), Catch::Contains(why));
    CHECK(test::contentsBelow(folder.path()).empty());
  };
  refused([](HtmModel& m) { m.cameras[1].name = "\xff"; }, "cameras[1].name");
  refused([](HtmModel& m) { m.cameras[1].imageFile = "/etc/passwd"; }, "cameras[1].imageFile");
  refused([](HtmModel& m) { m.cameras[2].visibilityFile = "../up.png"; }, "cameras[2].visibilityFile");
  refused([](HtmModel& m) { m.settings = "{"; }, "settings");
  refused([](HtmModel& m) { m.surface.mesh.triangles.clear(); }, "triangle");
}

TEST_CASE("the kind of an asset is known from its folder or document") {
  test::TemporaryFolder folder;
  CHECK_FALSE(assetKind(folder.path()).has_value());
  CHECK_FALSE(assetKind(folder / "missing").has_value());
  saveHtmModel(model(), folder.path());
  CHECK(assetKind(folder.path()) == AssetKind::htmModel);
  CHECK(assetKind(folder / "model.gltf") == AssetKind::htmModel);
  saveScene({}, folder / "scene");
  CHECK(assetKind(folder / "scene") == AssetKind::scene);
  CHECK(assetKind(folder / "scene/scene.gltf") == AssetKind::scene);
  writeFile(folder / "other.gltf", R"({"asset":{"version":"2.0"}})");
  CHECK_FALSE(assetKind(folder / "other.gltf").has_value());
  writeFile(folder / "broken.gltf", "{");
  CHECK_FALSE(assetKind(folder / "broken.gltf").has_value());
}

}  // namespace
}  // namespace ibr
