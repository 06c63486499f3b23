// SPDX-License-Identifier: Apache-2.0
// `ibr info` and `ibr validate` on harmonised models.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "apps/support/run_program.h"
#include "ibr/htm_sequence.h"
#include "support/json.h"
#include "support/temporary_folder.h"
#include "support/test_meshes.h"

using namespace ibr;
using namespace ibr::test;

namespace {

HtmModel tinyModel() {
  HtmModel model;
  for (const char* name : {"a.png", "b.png", "c.png"}) {
    HtmCamera camera;
    camera.name = name;
    camera.camera.intrinsics = {CameraModel::pinhole, 64, 48, 50, 50, 32, 24};
    camera.imageFile = name;
    model.cameras.push_back(camera);
  }
  model.surface.mesh = cube();
  model.surface.members = {7, 7, 7, 7, 3, 3, 3, 0};
  model.complements.assign(9 * 8, glm::vec2(3, 4));
  return model;
}

}  // namespace

TEST_CASE("info and validate accept a harmonised model") {
  TemporaryFolder folder;
  saveHtmModel(tinyModel(), folder.path());
  for (const std::string& path : {folder.path().string(), (folder / "model.gltf").string()}) {
    const Outcome info = runProgram({"info", path, "--json", "-"});
    CHECK(info.code == 0);
    const auto report = parseJson(info.out.substr(info.out.find('{')));
    CHECK(report["faces"] == 12);
    CHECK(report["vertices"] == 8);
    CHECK(report["cameras"] == 3);
    CHECK(report["complementBytes"]["predicted"] == 8 * 9 * 8);
    CHECK(report["complementBytes"]["real"] == 8 * 9 * 8);
    CHECK(report["complementRmsPx"] == 5.0);
    CHECK(report["membersPerVertex"] == 18.0 / 8);
    CHECK(report["verticesWithoutCamera"] == 1);
  }
  CHECK_THAT(runProgram({"info", folder.path().string()}).out,
             Catch::Contains("12 faces") && Catch::Contains("8 vertices"));
  CHECK(runProgram({"info", folder.path().string(), "--explain"}).code == 5);

  const Outcome faults = runProgram({"validate", folder.path().string()});
  CHECK(faults.code == 3);
  CHECK_THAT(faults.out,
             Catch::Contains("/extensions/IBR_harmonised_texture/cameras/2/image") && Catch::Contains("c.png"));
}

TEST_CASE("info and validate accept 3D video") {
  TemporaryFolder folder;
  saveHtmModel(tinyModel(), folder / "one");
  saveHtmModel(tinyModel(), folder / "two");
  saveHtmSequence({12.5, {"one", "two"}}, folder.path());
  const Outcome info = runProgram({"info", (folder / "sequence.json").string(), "--json", "-"});
  CHECK(info.code == 0);
  const auto report = parseJson(info.out.substr(info.out.find('{')));
  CHECK(report["frames"] == 2);
  CHECK(report["seconds"] == 0.16);
  CHECK(report["cameras"] == 3);
  CHECK(report["complementBytes"] == 8 * 9 * 8);
  const Outcome faults = runProgram({"validate", folder.path().string()});
  CHECK(faults.code == 3);
  CHECK_THAT(faults.out, Catch::Contains("/frames/1") && Catch::Contains("two") && Catch::Contains("/extensions") &&
                             Catch::Contains("6 fault"));
}
