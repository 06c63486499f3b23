// SPDX-License-Identifier: Apache-2.0
// NUMERICS §7.1 for scene files: a good scene, spoilt in one place at a time. Each time loadScene throws an Error that
// names file and place, and validateSceneFiles reports it; nothing else ever happens.
#include <sys/stat.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <clocale>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <set>

#include "base/file.h"
#include "example_scene.h"
#include "ibr/error.h"
#include "support/temporary_folder.h"

namespace fs = std::filesystem;
using namespace ibr;

namespace {

using Json = nlohmann::json;

const std::string kExtension = "/extensions/IBR_image_graph";

// A good scene on disk, and its document.
struct Example {
  test::TemporaryFolder folder;
  Json document;
  Example() {
    test::writeExampleScene(folder.path());
    document = Json::parse(readTextFile(folder / "scene.gltf"));
  }
  void write(const Json& json) const { writeFile(folder / "scene.gltf", json.dump()); }
  void restore() const { write(document); }
  fs::path bufferOf(std::size_t cell) const { return folder / document["buffers"][cell]["uri"].get<std::string>(); }
};

Example& example() {
  static Example instance;
  return instance;
}

struct Refusal {
  ErrorCode code;
  std::string message;
};

// What loadScene says; validateSceneFiles must find fault with the place too.
Refusal refusal(const fs::path& path, const std::string& place = {}) {
  const std::vector<Fault> faults = validateSceneFiles(path);
  CHECK_FALSE(faults.empty());
  if (!place.empty())
    CHECK(std::any_of(faults.begin(), faults.end(), [&](const Fault& f) { return f.field == place; }));
  try {
    loadScene(path);
  } catch (const Error& e) {
    return {e.code(), e.what()};
  }
  FAIL("nothing was thrown");
  return {};
}

// Writes the example with the value at `pointer` replaced by a piece of JSON text, and expects it to be refused there
// (or at `place`).
void refuse(const std::string& pointer, const std::string& text, std::string place = {}) {
  if (place.empty()) place = pointer;
  INFO(pointer << " = " << text << ", expected at " << place);
  Json wrong = example().document;
  wrong[Json::json_pointer(pointer)] = "@";  // what no parser's number can be is put in as text
  std::string document = wrong.dump();
  document.replace(document.find("\"@\""), 3, text);
  writeFile(example().folder / "scene.gltf", document);
  const Refusal r = refusal(example().folder.path(), place);
  CHECK(r.code == ErrorCode::invalidInput);
  CHECK_THAT(r.message, Catch::Contains("scene.gltf") && Catch::Contains(place));
  example().restore();
}

void refuseWithout(const std::string& pointer) {
  const Json::json_pointer whole(pointer);
  const std::string place = whole.parent_pointer().to_string();
  INFO(pointer << " is missing, expected at " << place);
  Json wrong = example().document;
  wrong.at(whole.parent_pointer()).erase(whole.back());
  example().write(wrong);
  const Refusal r = refusal(example().folder.path(), place);
  CHECK(r.code == ErrorCode::invalidInput);
  CHECK_THAT(r.message, Catch::Contains("scene.gltf") && Catch::Contains(place) && Catch::Contains(whole.back()));
  example().restore();
}

}  // namespace

TEST_CASE("the example is good") {
  for (const Fault& fault : validateSceneFiles(example().folder.path())) FAIL(fault.field << " " << fault.message);
  CHECK(loadScene(example().folder.path()).cells.size() == 6);
}

TEST_CASE("whole numbers are whole, in range, and numbers") {
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
  // Values that wrap to good ones in 32 bits.
  refuse("/accessors/0/count", "4294967297");
  for (const std::string pointer : {"/accessors/0/bufferView", "/bufferViews/0/buffer"}) refuse(pointer, "4294967296");
  refuse("/extensions/IBR_image_graph/cells/0/members/1", "4294967297");
  refuse("/extensions/IBR_image_graph/photographs/1/camera/width", "4294967360");
  refuse("/extensions/IBR_image_graph/version", "2");
  refuse("/extensions/IBR_image_graph/version", "0");
}

TEST_CASE("numbers are numbers, finite and in range") {
  for (const std::string pointer :
       {"/nodes/0/translation/1", "/nodes/0/rotation/3", "/extensions/IBR_image_graph/photographs/0/camera/fx",
        "/extensions/IBR_image_graph/photographs/0/camera/cx", "/extensions/IBR_image_graph/origin/heightMetres",
        "/extensions/IBR_image_graph/cells/1/quality/coverage"}) {
    for (const std::string value : {"\"0.5\"", "null", "true", "[1]", "{}"}) refuse(pointer, value);
    for (const std::string value : {"1e999", "-1e999", "NaN", "Infinity", "0x10", "1,5", "+1", ".5", "01"}) {
      INFO(pointer << " = " << value);
      std::string document = example().document.dump();
      Json wrong = example().document;
      wrong[Json::json_pointer(pointer)] = "@";
      document = wrong.dump();
      document.replace(document.find("\"@\""), 3, value);
      writeFile(example().folder / "scene.gltf", document);
      const Refusal r = refusal(example().folder.path());
      CHECK(r.code == ErrorCode::invalidInput);
      CHECK_THAT(r.message, Catch::Contains("scene.gltf"));
      example().restore();
    }
  }
  for (const std::string focal : {"fx", "fy"})
    for (const std::string value : {"0", "-0.0", "-500"}) refuse(kExtension + "/photographs/0/camera/" + focal, value);
}

TEST_CASE("rotations are of unit length, vectors have their size") {
  for (const std::string value : {"[0,0,0,0]", "[0,0,0,1.01]", "[0,0,0.1,1]", "[0,0,0]", "[0,0,0,1,0]", "{}", "1"})
    refuse("/nodes/0/rotation", value);
  for (const std::string value : {"[0,0]", "[0,0,0,0]", "\"000\""}) refuse("/nodes/0/translation", value);
  // Renormalised within 1e-3.
  Json nearly = example().document;
  nearly["nodes"][0]["rotation"] = {0, 0, 0, 1.0009};
  example().write(nearly);
  CHECK(loadScene(example().folder.path()).nodes[0].camera.pose.rotation == glm::dquat(1, 0, 0, 0));
  example().restore();
}

TEST_CASE("what must be there is there") {
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
  // Lists of glTF that something refers to.
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

TEST_CASE("every key of ours and every list of glTF may be of a wrong kind") {
  // Each value of the document in turn becomes something else; whatever is said, it is an Error or a scene.
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

TEST_CASE("keys stand once, and nesting has an end") {
  std::string document = example().document.dump();
  const auto twice = [&](std::string_view after, std::string_view inserted) {
    std::string wrong = document;
    const std::size_t at = wrong.find(after);
    REQUIRE(at != std::string::npos);
    wrong.insert(at + after.size(), inserted);
    writeFile(example().folder / "scene.gltf", wrong);
    const Refusal r = refusal(example().folder.path());
    CHECK(r.code == ErrorCode::invalidInput);
    CHECK_THAT(r.message, Catch::Contains("scene.gltf") && Catch::Contains("twice"));
    return r.message;
  };
  CHECK_THAT(twice("{", R"("asset":{},)"), Catch::Contains("asset"));
  CHECK_THAT(twice(R"("IBR_image_graph":{)", R"("version":1,)"), Catch::Contains("/extensions/IBR_image_graph"));
  for (const auto& [open, close] : {std::pair{"[", "]"}, std::pair{"{\"a\":", "}"}}) {
    std::string deep;
    for (int i = 0; i < 1'000'000; ++i) deep += open;
    writeFile(example().folder / "scene.gltf", "{\"a\":" + deep);
    CHECK_THAT(refusal(example().folder.path()).message, Catch::Contains("scene.gltf") && Catch::Contains("deep"));
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

TEST_CASE("a document cut anywhere is refused") {
  const std::string document = example().document.dump();
  for (std::size_t length = 0; length < document.size(); length += 97) {
    writeFile(example().folder / "scene.gltf", std::string_view(document).substr(0, length));
    CHECK(refusal(example().folder.path()).code == ErrorCode::invalidInput);
  }
  example().restore();
}

TEST_CASE("names, members and links") {
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
  // A second backdrop of one photograph.
  Json wrong = example().document;
  Json& backdrops = wrong.at(Json::json_pointer(kExtension + "/backdrops"));
  backdrops.push_back(backdrops[0]);
  example().write(wrong);
  CHECK_THAT(refusal(example().folder.path()).message, Catch::Contains("backdrops"));
  example().restore();
}

TEST_CASE("photographs stand by themselves in the node hierarchy") {
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

TEST_CASE("extensions that are required and unknown are refused") {
  Json wrong = example().document;
  wrong["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  example().write(wrong);
  CHECK_THAT(refusal(example().folder.path()).message, Catch::Contains("KHR_draco_mesh_compression"));
  wrong["extensionsRequired"] = {"IBR_image_graph", "KHR_materials_unlit"};
  example().write(wrong);
  CHECK_NOTHROW(loadScene(example().folder.path()));
  example().restore();
}

TEST_CASE("accessors keep inside their views, and views inside their buffers") {
  const Json& document = example().document;
  const auto length = document["buffers"][0]["byteLength"].get<std::size_t>();
  refuse("/accessors/0/type", "\"VEC2\"");
  refuse("/accessors/0/type", "\"MAT4\"");
  refuse("/accessors/0/type", "\"\"");
  refuse("/accessors/0/componentType", "5123");
  refuse("/accessors/0/componentType", "5130");
  refuse("/accessors/0/count", "0");
  refuse("/accessors/0/byteOffset", "4", "/accessors/0");
  refuse("/accessors/0/byteOffset", "2");  // not aligned to its components
  refuse("/accessors/0/normalized", "true");
  refuse("/accessors/0/sparse", "{}");
  refuse("/bufferViews/0/byteStride", "8");
  refuse("/bufferViews/0/byteStride", "14");  // not a multiple of 4
  refuse("/bufferViews/0/byteStride", "16", "/accessors/0");
  refuse("/bufferViews/0/byteStride", "256");
  refuse("/bufferViews/0/byteOffset", std::to_string(length), "/bufferViews/0");
  refuse("/bufferViews/0/byteOffset", "2");  // aligned in the view is not aligned in the buffer
  refuse("/bufferViews/0/byteLength", std::to_string(length + 4), "/bufferViews/0");
  refuse("/buffers/0/byteLength", std::to_string(length + 4));
  refuse("/buffers/0/byteLength", std::to_string(length - 4), "/bufferViews/8");
  refuse("/meshes/0/primitives/0/mode", "1");
  refuse("/meshes/0/primitives/1/attributes/_RATIO", "4", "/meshes/0/primitives/1/attributes");
  const auto ofMesh = [&](const char* what, int primitive) {
    return "/accessors/" + std::to_string(document["meshes"][0]["primitives"][std::size_t(primitive)][what].get<int>());
  };
  const std::string indices = ofMesh("indices", 0);
  refuse(indices + "/componentType", "5126");
  refuse(indices + "/componentType", "5121");
  refuse(indices + "/componentType", "5125", indices);
  const int count = document.at(Json::json_pointer(indices + "/count")).get<int>();
  refuse(indices + "/count", std::to_string(count - 1));
  const std::string ecc =
      "/accessors/" + std::to_string(document.at(Json::json_pointer(kExtension + "/cells/0/ecc/0")).get<int>());
  refuse(indices + "/count", std::to_string(count - 3), ecc + "/count");
  refuse("/accessors/3/count", "3", "/accessors/1/count");  // _RATIO has fewer points than TEXCOORD_0
}

TEST_CASE("values of a buffer are checked, with their place") {
  const Json& document = example().document;
  const std::vector<std::byte> good = readFile(example().bufferOf(0));
  const Json& attributes = document["meshes"][0]["primitives"][0]["attributes"];
  const auto start = [&](int accessor) {
    const Json& a = document["accessors"][std::size_t(accessor)];
    return document["bufferViews"][a["bufferView"].get<std::size_t>()]["byteOffset"].get<std::size_t>();
  };
  const auto poke = [&](int accessor, std::size_t element, auto value) {
    std::vector<std::byte> bytes = good;
    std::memcpy(&bytes.at(start(accessor) + element * sizeof value), &value, sizeof value);
    writeFile(example().bufferOf(0), bytes);
    const std::string place = "/accessors/" + std::to_string(accessor);
    INFO(place << "[" << element << "] = " << value);
    CHECK_THAT(refusal(example().folder.path(), place).message,
               Catch::Contains("scene.gltf") && Catch::Contains(place) && Catch::Contains("element"));
    writeFile(example().bufferOf(0), good);
  };
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  for (float wrong : {nan, infinity, -infinity}) {
    for (const auto& [name, accessor] : attributes.items()) poke(accessor.get<int>(), 3, wrong);
    poke(document.at(Json::json_pointer(kExtension + "/cells/0/ecc/0")).get<int>(), 2, wrong);
  }
  for (float wrong : {0.0f, -0.0f, -1.0f}) poke(attributes["_RATIO"].get<int>(), 5, wrong);
  poke(attributes["_INVERSE_DISTANCE"].get<int>(), 1, -1e-30f);
  poke(attributes["_UNCERTAINTY"].get<int>(), 1, -1.0f);
  poke(document.at(Json::json_pointer(kExtension + "/cells/0/ecc/1")).get<int>(), 0, 1.5f);
  poke(attributes["POSITION"].get<int>(), 4, 1e6f);
  const auto points = document["accessors"][0]["count"].get<std::uint16_t>();
  poke(document["meshes"][0]["primitives"][0]["indices"].get<int>(), 7, points);
  poke(document["meshes"][0]["primitives"][1]["indices"].get<int>(), 0, std::uint16_t(65535));
  // A swapped member shows in the derived positions.
  Json swapped = document;
  swapped.at(Json::json_pointer(kExtension + "/cells/1/members")) = {0, 2, 1};
  example().write(swapped);
  CHECK_THAT(refusal(example().folder.path()).message, Catch::Contains("element 0"));
  example().restore();
}

TEST_CASE("a buffer file that is cut, missing or no file is named") {
  const fs::path file = example().bufferOf(0);
  const std::vector<std::byte> good = readFile(file);
  for (std::size_t length : {std::size_t(0), std::size_t(1), good.size() / 2, good.size() - 1}) {
    writeFile(file, std::span(good).first(length));
    CHECK_THAT(refusal(example().folder.path(), "/buffers/0/byteLength").message,
               Catch::Contains(file.filename().string()));
  }
  fs::remove(file);
  CHECK(refusal(example().folder.path()).code == ErrorCode::io);
  CHECK_THAT(refusal(example().folder.path()).message, Catch::Contains(file.filename().string()));
  fs::create_directory(file);
  CHECK(refusal(example().folder.path()).code == ErrorCode::io);
  fs::remove(file);
  REQUIRE(::mkfifo(file.c_str(), 0600) == 0);
  CHECK(refusal(example().folder.path()).code == ErrorCode::io);
  fs::remove(file);
  fs::create_symlink("/dev/zero", file);
  CHECK_THAT(refusal(example().folder.path(), "/buffers/0/uri").message, Catch::Contains("outside"));
  fs::remove(file);
  // Longer than it says is allowed: glTF pads.
  std::vector<std::byte> longer = good;
  longer.resize(good.size() + 3);
  writeFile(file, longer);
  CHECK_NOTHROW(loadScene(example().folder.path()));
  writeFile(file, good);
}

TEST_CASE("references stay inside the scene's folder") {
  fs::create_directory_symlink("/etc", example().folder / "link");
  for (const std::string pointer :
       {"/buffers/0/uri", "/images/0/uri", "/extensions/IBR_image_graph/photographs/0/texture/uri"})
    for (const std::string uri :
         {"../x", "cells/../../x", "/etc/passwd", "file:///etc/passwd", "http://localhost/x", "data:,x", "link/passwd",
          "%2e%2e/x", "..%2Fx", "%2Fetc%2Fpasswd", "", ".", "a%00b", "a%2", "C:\\x", "..\\x"})
      refuse(pointer, Json(uri).dump());
  fs::remove(example().folder / "link");
  // Names that only look like it.
  const fs::path file = example().bufferOf(0);
  fs::create_directory(example().folder / "cells/..b");
  fs::copy_file(file, example().folder / "cells/..b/a..b.bin");
  Json document = example().document;
  document["buffers"][0]["uri"] = "cells/..b/a..b.bin";
  example().write(document);
  CHECK_NOTHROW(loadScene(example().folder.path()));
  example().restore();
  fs::remove_all(example().folder / "cells/..b");
}

TEST_CASE("textures that are missing or do not match are found by validation") {
  const fs::path texture = example().folder / "textures/view1.ktx2", photograph = example().folder / "images/view2.png";
  const std::vector<std::byte> good = readFile(texture), picture = readFile(photograph);
  const std::string place = kExtension + "/photographs/1/texture";
  const auto found = [&](const std::string& field, const std::string& words) {
    const std::vector<Fault> faults = validateSceneFiles(example().folder.path());
    REQUIRE(faults.size() == 1);
    CHECK(faults[0].field == field);
    CHECK_THAT(faults[0].message, Catch::Contains(words));
    CHECK_NOTHROW(loadScene(example().folder.path()));
  };
  fs::remove(texture);
  found(place, "view1.ktx2");
  fs::copy_file(example().folder / "textures/view2.ktx2", texture);
  found(place, "80x80");
  fs::remove(texture);
  writeFile(texture, std::span(good).first(good.size() - 1));
  found(place, "levels[0]");
  writeFile(texture, good);
  fs::remove(photograph);
  found(kExtension + "/photographs/2/image", "view2.png");
  writeFile(photograph, picture);
  Json without = example().document;
  without.at(Json::json_pointer(kExtension + "/photographs/0")).erase("texture");
  example().write(without);
  found(kExtension + "/photographs/0", "texture");
  example().restore();
}

TEST_CASE("several faults are all reported, up to the limit") {
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
  example().restore();
}

TEST_CASE("paths that are no scene") {
  const test::TemporaryFolder folder;
  CHECK(refusal(folder.path()).code == ErrorCode::io);
  CHECK(refusal(folder / "missing").code == ErrorCode::io);
  CHECK_THAT(refusal(folder / "missing/scene.gltf").message, Catch::Contains("missing/scene.gltf"));
  CHECK(refusal("/dev/null").code == ErrorCode::io);
  CHECK(refusal("").code == ErrorCode::io);
  const std::string longName(5000, 'x');
  CHECK(refusal(folder / longName).code == ErrorCode::io);
}

TEST_CASE("a locale with decimal commas changes nothing") {
  const char* const set = std::setlocale(LC_ALL, "de_DE.UTF-8");
  const Scene scene = loadScene(example().folder.path());
  if (set) std::setlocale(LC_ALL, "C");
  CHECK(scene.nodes[0].camera.intrinsics == test::exampleScene().nodes[0].camera.intrinsics);
  if (!set) WARN("the locale de_DE.UTF-8 is not installed");
}

TEST_CASE("bytes flipped at random never do harm") {
  const std::string document = example().document.dump();
  const std::vector<std::byte> buffer = readFile(example().bufferOf(0));
  std::mt19937 random(1);
  for (int round = 0; round < 400; ++round) {
    std::string text = document;
    std::vector<std::byte> bytes = buffer;
    for (int flips = 1 + int(random() % 3); flips > 0; --flips)
      if (round % 2)
        text[random() % text.size()] = char(random());
      else
        bytes[random() % bytes.size()] = std::byte(random());
    writeFile(example().folder / "scene.gltf", text);
    writeFile(example().bufferOf(0), bytes);
    try {
      const Scene scene = loadScene(example().folder.path());
      CHECK(validate(scene).empty());
    } catch (const Error&) {
    }
  }
  writeFile(example().bufferOf(0), buffer);
  example().restore();
}

TEST_CASE("scenes that cannot be written are refused, and nothing is left") {
  const test::TemporaryFolder folder;
  Scene scene = test::exampleScene();
  const auto refused = [&](ErrorCode code, const std::string& words) {
    try {
      saveScene(scene, folder / "scene");
      FAIL("nothing was thrown");
    } catch (const Error& e) {
      CHECK(e.code() == code);
      CHECK_THAT(e.what(), Catch::Contains(words));
    }
    CHECK_FALSE(fs::exists(folder / "scene/scene.gltf"));
    scene = test::exampleScene();
  };
  scene.nodes[1].name = "photo \xff";  // not UTF-8
  refused(ErrorCode::invalidInput, "nodes[1].name");
  scene.settings = "{\"seed\":";
  refused(ErrorCode::invalidInput, "settings");
  scene.settings = "\xff";
  refused(ErrorCode::invalidInput, "settings");
  scene.acquisition = "\xc3(";
  refused(ErrorCode::invalidInput, "acquisition");
  scene.nodes[0].imageFile = "/etc/passwd";
  refused(ErrorCode::invalidInput, "nodes[0].imageFile");
  scene.nodes[0].textureFile = "../textures/view0.ktx2";
  refused(ErrorCode::invalidInput, "nodes[0].textureFile");
  writeFile(folder / "file", "x");
  CHECK_THROWS_AS(saveScene(scene, folder / "file/scene"), Error);
  // File names are bytes: they need not be UTF-8.
  scene.nodes[0].imageFile = "images/\xff%20 \xc3\xa4.png";
  saveScene(scene, folder / "scene");
  CHECK(loadScene(folder / "scene").nodes[0].imageFile == scene.nodes[0].imageFile);
}

TEST_CASE("settings of any kind come back with the same values") {
  const test::TemporaryFolder folder;
  Scene scene;
  for (const std::string settings : {R"({"z":1,"a":{"y":2.5,"b":[1,2]},"m":"\u00e4"})", "[]", "{}", "\"x\"", "0"}) {
    scene.settings = settings;
    saveScene(scene, folder.path());
    CHECK(Json::parse(loadScene(folder.path()).settings) == Json::parse(settings));
  }
}
