// SPDX-License-Identifier: Apache-2.0
// Scenes that cannot be saved.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "example_scene.h"
#include "ibr/scene.h"
#include "spoilt_scene.h"
#include "support/json.h"

namespace fs = std::filesystem;
using namespace ibr;
using namespace ibr::test;

TEST_CASE("scenes that cannot be written are refused and leave no file") {
  const TemporaryFolder folder;
  Scene scene = exampleScene();
  const auto refused = [&](ErrorCode code, const std::string& words) {
    try {
      saveScene(scene, folder / "scene");
      FAIL("nothing was thrown");
    } catch (const Error& e) {
      CHECK(e.code() == code);
      CHECK_THAT(e.what(), Catch::Contains(words));
    }
    CHECK_FALSE(fs::exists(folder / "scene/scene.gltf"));
    scene = exampleScene();
  };
  scene.nodes[1].name = "photo \xff";  // invalid UTF-8
  refused(ErrorCode::invalidInput, "nodes[1].name");
  scene.settings = "{\"seed\":";
  refused(ErrorCode::invalidInput, "settings");
  scene.settings = "\xff";
  refused(ErrorCode::invalidInput, "settings");
  scene.unusedPhotographs = {{"a", "\xc3("}};
  refused(ErrorCode::invalidInput, "unused[0].reason");
  scene.acquisition = "\xc3(";
  refused(ErrorCode::invalidInput, "acquisition");
  scene.nodes[0].imageFile = "/etc/passwd";
  refused(ErrorCode::invalidInput, "nodes[0].imageFile");
  scene.nodes[0].textureFile = "../textures/view0.ktx2";
  refused(ErrorCode::invalidInput, "nodes[0].textureFile");
  scene.nodes[0].depthFile = "../depth/view0.ktx2";
  refused(ErrorCode::invalidInput, "nodes[0].depthFile");
  scene.cells[0].mesh.confirmations = {1};
  refused(ErrorCode::invalidInput, "cells[0].mesh.confirmations");
  writeFile(folder / "file", "x");
  CHECK_THROWS_AS(saveScene(scene, folder / "file/scene"), Error);
  // File names are bytes and need not be valid UTF-8.
  scene.nodes[0].imageFile = "images/\xff%20 \xc3\xa4.png";
  saveScene(scene, folder / "scene");
  CHECK(loadScene(folder / "scene").nodes[0].imageFile == scene.nodes[0].imageFile);
}

TEST_CASE("settings of any JSON type load with the same values") {
  const TemporaryFolder folder;
  Scene scene;
  for (const std::string settings : {R"({"z":1,"a":{"y":2.5,"b":[1,2]},"m":"\u00e4"})", "[]", "{}", "\"x\"", "0"}) {
    scene.settings = settings;
    saveScene(scene, folder.path());
    CHECK(parseJson(loadScene(folder.path()).settings) == parseJson(settings));
  }
}
