// SPDX-License-Identifier: Apache-2.0
// Faults in scene.gltf.
#include <algorithm>
#include <catch2/catch.hpp>
#include <clocale>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>

#include "base/file.h"
#include "example_scene.h"
#include "ibr/scene.h"
#include "spoilt_scene.h"
#include "support/json.h"

namespace fs = std::filesystem;
using namespace ibr;
using namespace ibr::test;

TEST_CASE("the example scene is valid") {
  for (const Fault& fault : validateSceneFiles(example().folder.path())) FAIL(fault.field << " " << fault.message);
  CHECK(loadScene(example().folder.path()).cells.size() == 6);
}

TEST_CASE("integer fields refuse fractions, other types and values out of range") {
  for (const std::string pointer :
       {"/accessors/0/count", "/accessors/0/componentType", "/accessors/0/bufferView", "/bufferViews/0/buffer",
        "/bufferViews/0/byteOffset", "/bufferViews/0/byteLength", "/buffers/0/byteLength",
        "/extensions/IBR_image_graph/version", "/extensions/IBR_image_graph/photographs/1/node",
        "/extensions/IBR_image_graph/photographs/1/image", "/extensions/IBR_image_graph/photographs/1/camera/width",
        "/extensions/IBR_image_graph/photographs/4/camera/height", "/extensions/IBR_image_graph/cells/0/members/1",
        "/extensions/IBR_image_graph/cells/0/mesh", "/extensions/IBR_image_graph/cells/0/tiers/0",
        "/extensions/IBR_image_graph/cells/0/ecc/0", "/meshes/0/primitives/0/indices"})
    for (const std::string value : {"-1", "3.7", "3.0", "1e30", "18446744073709551615", "18446744073709551616", "\"3\"",
                                    "null", "true", "[]", "{}", "-9223372036854775809"})
      refuse(pointer, value);
  // Values that become valid after wrap-around to 32 bits.
  refuse("/accessors/0/count", "4294967297");
  for (const std::string pointer : {"/accessors/0/bufferView", "/bufferViews/0/buffer"}) refuse(pointer, "4294967296");
  refuse("/extensions/IBR_image_graph/cells/0/members/1", "4294967297");
  refuse("/extensions/IBR_image_graph/photographs/1/camera/width", "4294967360");
  refuse("/extensions/IBR_image_graph/version", "1");
  refuse("/extensions/IBR_image_graph/version", "3");
  refuse("/extensions/IBR_image_graph/version", "0");
}

TEST_CASE("numbers must be finite and within range", "[P2][N16]") {
  for (const std::string pointer :
       {"/nodes/0/translation/1", "/nodes/0/rotation/3", "/extensions/IBR_image_graph/photographs/0/camera/fx",
        "/extensions/IBR_image_graph/photographs/0/camera/cx", "/extensions/IBR_image_graph/origin/heightMetres",
        "/extensions/IBR_image_graph/cells/1/quality/coverage", "/extensions/IBR_image_graph/cells/1/quality/score"}) {
    for (const std::string value : {"\"0.5\"", "null", "true", "[1]", "{}"}) refuse(pointer, value);
    for (const std::string value : {"1e999", "-1e999", "NaN", "Infinity", "0x10", "1,5", "+1", ".5", "01"}) {
      INFO(pointer << " = " << value);
      std::string document = jsonLine(example().document);
      Json wrong = example().document;
      wrong[Json::json_pointer(pointer)] = "@";
      document = jsonLine(wrong);
      document.replace(document.find("\"@\""), 3, value);
      writeFile(example().folder / "scene.gltf", document);
      const Refusal r = refusal(example().folder.path());
      CHECK(r.code == ErrorCode::invalidInput);
      CHECK_THAT(r.message, Catch::Contains("scene.gltf"));
      example().restore();
    }
  }
  const std::string quality = kExtension + "/cells/1/quality/";
  for (const std::string share : {"coverage", "score"})
    for (const std::string value : {"-0.01", "1.01", "-1e300"}) refuse(quality + share, value);
  for (const std::string value : {"-1.01", "1.01"}) refuse(quality + "ecc", value);
  refuse(quality + "residualPx", "-0.01");
  for (const std::string value : {"0", "-1", "4097", "0.0002"}) refuse(kExtension + "/photographs/1/gain/2", value);
  for (const std::string value : {"[1,1]", "[1,1,1,1]", "1"}) refuse(kExtension + "/photographs/1/gain", value);
  for (const std::string value : {"0", "-0.25", "\"1\"", "null"})
    refuse(kExtension + "/photographs/0/depth/scale", value);
  const std::string capture = kExtension + "/photographs/1/capture";
  for (const std::string number : {"exposureTime", "fNumber", "iso"})
    for (const std::string value : {"0", "-1", "\"1\""}) refuse(capture + "/" + number, value);
  refuse(capture + "/model", "1");
  refuse(capture, "[]");
  for (const std::string focal : {"fx", "fy"})
    for (const std::string value : {"0", "-0.0", "-500"}) refuse(kExtension + "/photographs/0/camera/" + focal, value);
}

TEST_CASE("rotations must have unit length, and vectors their size") {
  for (const std::string value : {"[0,0,0,0]", "[0,0,0,1.01]", "[0,0,0.1,1]", "[0,0,0]", "[0,0,0,1,0]", "{}", "1"})
    refuse("/nodes/0/rotation", value);
  for (const std::string value : {"[0,0]", "[0,0,0,0]", "\"000\""}) refuse("/nodes/0/translation", value);
  // Rotations within 1e-3 of unit length are normalised.
  Json nearly = example().document;
  nearly["nodes"][0]["rotation"] = {0, 0, 0, 1.0009};
  example().write(nearly);
  CHECK(loadScene(example().folder.path()).nodes[0].camera.pose.rotation == glm::dquat(1, 0, 0, 0));
  example().restore();
}

TEST_CASE("missing members of a scene are refused") {
  for (const std::string pointer : {"/asset",
                                    "/asset/version",
                                    "/extensions",
                                    "/extensions/IBR_image_graph",
                                    "/extensions/IBR_image_graph/version",
                                    "/extensions/IBR_image_graph/photographs",
                                    "/extensions/IBR_image_graph/cells",
                                    "/extensions/IBR_image_graph/backdrops",
                                    "/extensions/IBR_image_graph/photographs/0/node",
                                    "/extensions/IBR_image_graph/photographs/0/camera",
                                    "/extensions/IBR_image_graph/photographs/0/camera/model",
                                    "/extensions/IBR_image_graph/photographs/0/camera/width",
                                    "/extensions/IBR_image_graph/photographs/0/camera/height",
                                    "/extensions/IBR_image_graph/photographs/0/camera/fx",
                                    "/extensions/IBR_image_graph/photographs/0/camera/cy",
                                    "/extensions/IBR_image_graph/photographs/0/texture/uri",
                                    "/extensions/IBR_image_graph/photographs/1/mask/uri",
                                    "/extensions/IBR_image_graph/photographs/0/depth/uri",
                                    "/extensions/IBR_image_graph/photographs/0/depth/scale",
                                    "/extensions/IBR_image_graph/cells/0/members",
                                    "/extensions/IBR_image_graph/cells/0/tiers",
                                    "/extensions/IBR_image_graph/cells/0/ecc",
                                    "/extensions/IBR_image_graph/origin/latitudeDegrees",
                                    "/nodes/0/name",
                                    "/images/0/uri",
                                    "/meshes/0/primitives",
                                    "/meshes/0/primitives/0/attributes",
                                    "/meshes/0/primitives/0/indices",
                                    "/meshes/0/primitives/0/attributes/_RATIO",
                                    "/accessors/0/bufferView",
                                    "/accessors/0/componentType",
                                    "/accessors/0/count",
                                    "/accessors/0/type",
                                    "/bufferViews/0/buffer",
                                    "/bufferViews/0/byteLength",
                                    "/buffers/0/uri",
                                    "/buffers/0/byteLength"})
    refuseWithout(pointer);
  for (const std::string attribute : {"POSITION", "TEXCOORD_0", "TEXCOORD_1", "_INVERSE_DISTANCE", "_UNCERTAINTY"}) {
    Json wrong = example().document;
    for (auto& primitive : wrong["meshes"][0]["primitives"]) primitive["attributes"].erase(attribute);
    example().write(wrong);
    CHECK_THAT(refusal(example().folder.path(), "/meshes/0/primitives/0/attributes").message,
               Catch::Contains(attribute));
    example().restore();
  }
  // glTF lists that other parts refer to.
  for (const std::string list : {"nodes", "meshes", "accessors", "bufferViews", "buffers", "images"}) {
    INFO(list);
    Json wrong = example().document;
    wrong.erase(list);
    example().write(wrong);
    CHECK_THAT(refusal(example().folder.path()).message, Catch::Contains("scene.gltf") && Catch::Contains(list));
    wrong[list] = Json::object();
    example().write(wrong);
    CHECK_THAT(refusal(example().folder.path()).message, Catch::Contains("scene.gltf") && Catch::Contains(list));
    example().restore();
  }
}

TEST_CASE("a wrong type of any value in a scene's document gives an error or a valid scene") {
  // Replaces each value of the document in turn with other types. The outcome must be an Error or a scene.
  std::vector<std::string> pointers;
  const std::function<void(const Json&, const std::string&)> walk = [&](const Json& value, const std::string& at) {
    if (!at.empty()) pointers.push_back(at);
    if (value.is_object())
      for (const auto& [key, child] : value.items()) walk(child, at + '/' + key);
    if (value.is_array())
      for (std::size_t i = 0; i < value.size(); ++i) walk(value[i], at + '/' + std::to_string(i));
  };
  walk(example().document, "");
  std::size_t refused = 0;
  for (const std::string& pointer : pointers)
    for (const Json& value : {Json(nullptr), Json(-7), Json::array({1})}) {
      Json wrong = example().document;
      wrong[Json::json_pointer(pointer)] = value;
      example().write(wrong);
      INFO(pointer << " = " << value);
      try {
        const Scene scene = loadScene(example().folder.path());
        REQUIRE(validate(scene).empty());
      } catch (const Error& e) {
        ++refused;
        REQUIRE_THAT(e.what(), Catch::Contains("scene.gltf: /"));
      }
    }
  CHECK(refused > 1000);
  example().restore();
}

TEST_CASE("duplicate keys and deep nesting are refused", "[P1]") {
  std::string document = jsonLine(example().document);
  const auto twice = [&](std::string_view after, std::string_view inserted) {
    std::string wrong = document;
    const std::size_t at = wrong.find(after);
    REQUIRE(at != std::string::npos);
    wrong.insert(at + after.size(), inserted);
    writeFile(example().folder / "scene.gltf", wrong);
    const Refusal r = refusal(example().folder.path());
    CHECK(r.code == ErrorCode::invalidInput);
    CHECK_THAT(r.message, Catch::Contains("scene.gltf"));
    return r.message;
  };
  CHECK_THAT(twice("{", R"("asset":{},)"), Catch::Contains("asset"));
  CHECK_THAT(twice(R"("IBR_image_graph":{)", R"("version":2,)"), Catch::Contains("/extensions/IBR_image_graph"));
  for (const auto& [open, close] : {std::pair{"[", "]"}, std::pair{"{\"a\":", "}"}}) {
    std::string deep;
    for (int i = 0; i < 1'000'000; ++i) deep += open;
    writeFile(example().folder / "scene.gltf", "{\"a\":" + deep);
    CHECK_THAT(refusal(example().folder.path()).message, Catch::Contains("scene.gltf") && Catch::Contains("64"));
  }
  for (const std::string text :
       {"", " ", "{", "[]", "nul", "{\"asset\"", "{}x", "\xff", "\xef\xbb\xbf", "\"\\ud800\""}) {
    writeFile(example().folder / "scene.gltf", text);
    const Refusal r = refusal(example().folder.path());
    CHECK(r.code == ErrorCode::invalidInput);
    CHECK_THAT(r.message, Catch::Contains("scene.gltf"));
  }
  example().restore();
}

TEST_CASE("a truncated document is refused", "[P1]") {
  const std::string document = jsonLine(example().document);
  for (std::size_t length = 0; length < document.size(); length += 97) {
    writeFile(example().folder / "scene.gltf", std::string_view(document).substr(0, length));
    CHECK(refusal(example().folder.path()).code == ErrorCode::invalidInput);
  }
  example().restore();
}

TEST_CASE("duplicate names and wrong members, tiers and versions are refused") {
  refuse("/nodes/1/name", "\"view0\"", kExtension + "/photographs/1/node");
  refuse("/nodes/1/name", "\"\"");
  refuse(kExtension + "/photographs/1/node", "0", kExtension + "/photographs/1/node");
  refuse(kExtension + "/cells/0/members", "[0,0]", kExtension + "/cells/0/members/1");
  refuse(kExtension + "/cells/0/members", "[0,5]", kExtension + "/cells/0/members/1");
  refuse(kExtension + "/cells/0/members", "[0]");
  refuse(kExtension + "/cells/0/members", "[]");
  refuse(kExtension + "/cells/0/members", "[0,1,2,3,4]");
  refuse(kExtension + "/backdrops/0/members", "[0,1]");
  refuse(kExtension + "/cells/0/tiers", "[1,0]", kExtension + "/cells/0/tiers/1");
  refuse(kExtension + "/cells/0/tiers", "[0,0]", kExtension + "/cells/0/tiers/1");
  refuse(kExtension + "/cells/0/tiers", "[0,2]", kExtension + "/cells/0/tiers/1");
  refuse(kExtension + "/cells/0/tiers", "[0,1,1]");
  refuse(kExtension + "/cells/0/ecc", "[7]");
  refuse(kExtension + "/photographs/0/camera/model", "\"FISHEYE\"");
  refuse("/asset/version", "\"1.0\"");
  refuse("/asset/version", "\"3.0\"");
  // Two backdrops of one photograph.
  Json wrong = example().document;
  Json& backdrops = wrong.at(Json::json_pointer(kExtension + "/backdrops"));
  backdrops.push_back(backdrops[0]);
  example().write(wrong);
  CHECK_THAT(refusal(example().folder.path()).message, Catch::Contains("backdrops"));
  example().restore();
}

TEST_CASE("photographs must be root nodes without matrix and scale") {
  refuse("/nodes/0/scale", "[1,1,1]");
  refuse("/nodes/0/matrix", "[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]");
  refuse("/nodes/1/children", "[0]", kExtension + "/photographs/0/node");
  refuse("/nodes/0/children", "[0]", kExtension + "/photographs/0/node");
  refuse("/nodes/0/children", "[99]", "/nodes/0/children/0");
  Json cyclic = example().document;
  cyclic["nodes"][0]["children"] = {1};
  cyclic["nodes"][1]["children"] = {0};
  example().write(cyclic);
  CHECK_THAT(refusal(example().folder.path()).message, Catch::Contains("photographs/0/node"));
  example().restore();
}

TEST_CASE("unknown required extensions are refused") {
  Json wrong = example().document;
  wrong["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  example().write(wrong);
  CHECK_THAT(refusal(example().folder.path()).message, Catch::Contains("KHR_draco_mesh_compression"));
  wrong["extensionsRequired"] = {"IBR_image_graph", "KHR_materials_unlit"};
  example().write(wrong);
  CHECK_NOTHROW(loadScene(example().folder.path()));
  example().restore();
}

TEST_CASE("several faults are all reported, up to the limit", "[P2]") {
  Json wrong = example().document;
  wrong["nodes"][0]["name"] = 7;
  wrong["nodes"][2]["rotation"] = {0, 0, 0, 2};
  wrong["nodes"][3]["translation"] = {0, "a", 0};
  example().write(wrong);
  std::set<std::string> fields;
  for (const Fault& fault : validateSceneFiles(example().folder.path())) fields.insert(fault.field);
  for (const char* field : {"/nodes/0/name", "/nodes/2/rotation", "/nodes/3/translation/1"}) CHECK(fields.count(field));
  CHECK(validateSceneFiles(example().folder.path(), 2).size() == 2);
  wrong = example().document;
  for (int cell : {0, 2, 3}) wrong.at(Json::json_pointer(kExtension + "/cells/" + std::to_string(cell)))["mesh"] = 99;
  example().write(wrong);
  CHECK(validateSceneFiles(example().folder.path()).size() == 3);
  wrong = example().document;
  wrong.at(Json::json_pointer(kExtension + "/version")) = 9;  // several parts of the reader check it
  example().write(wrong);
  const std::vector<Fault> faults = validateSceneFiles(example().folder.path());
  CHECK(std::ranges::count(faults, kExtension + "/version", &Fault::field) == 1);
  example().restore();
}

TEST_CASE("paths without a scene are refused") {
  const TemporaryFolder folder;
  CHECK(refusal(folder.path()).code == ErrorCode::io);
  CHECK(refusal(folder / "missing").code == ErrorCode::io);
  CHECK_THAT(refusal(folder / "missing/scene.gltf").message, Catch::Contains("missing/scene.gltf"));
  CHECK(refusal("/dev/null").code == ErrorCode::io);
  CHECK(refusal("").code == ErrorCode::io);
  const std::string longName(5000, 'x');
  CHECK(refusal(folder / longName).code == ErrorCode::io);
}

TEST_CASE("a locale with decimal commas changes nothing", "[locale]") {
  const char* const set = std::setlocale(LC_ALL, "de_DE.UTF-8");
  const Scene scene = loadScene(example().folder.path());
  if (set) std::setlocale(LC_ALL, "C");
  CHECK(scene.nodes[0].camera.intrinsics == exampleScene().nodes[0].camera.intrinsics);
  if (!set) WARN("the locale de_DE.UTF-8 is not installed");
}
