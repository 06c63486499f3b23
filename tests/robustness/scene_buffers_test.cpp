// SPDX-License-Identifier: Apache-2.0
// Faults in accessors, buffer files and the other files beside scene.gltf.
#include <sys/stat.h>

#include <catch2/catch.hpp>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "base/file.h"
#include "ibr/scene.h"
#include "ibr/texture.h"
#include "spoilt_scene.h"
#include "support/json.h"

namespace fs = std::filesystem;
using namespace ibr;
using namespace ibr::test;

TEST_CASE("accessors outside of their views and views outside of their buffers are refused") {
  const Json& document = example().document;
  const auto length = document["buffers"][0]["byteLength"].get<std::size_t>();
  refuse("/accessors/0/type", "\"VEC2\"");
  refuse("/accessors/0/type", "\"MAT4\"");
  refuse("/accessors/0/type", "\"\"");
  refuse("/accessors/0/componentType", "5123");
  refuse("/accessors/0/componentType", "5130");
  refuse("/accessors/0/count", "0");
  refuse("/accessors/0/byteOffset", "4", "/accessors/0");
  refuse("/accessors/0/byteOffset", "2");  // not aligned to its component size
  refuse("/accessors/0/normalized", "true");
  refuse("/accessors/0/sparse", "{}");
  refuse("/bufferViews/0/byteStride", "8");
  refuse("/bufferViews/0/byteStride", "14");  // not a multiple of 4
  refuse("/bufferViews/0/byteStride", "16", "/accessors/0");
  refuse("/bufferViews/0/byteStride", "256");
  refuse("/bufferViews/0/byteOffset", std::to_string(length), "/bufferViews/0");
  refuse("/bufferViews/0/byteOffset", "2");  // aligned in the view, but not in the buffer
  refuse("/bufferViews/0/byteLength", std::to_string(length + 4), "/bufferViews/0");
  refuse("/buffers/0/byteLength", std::to_string(length + 4));
  refuse("/buffers/0/byteLength", std::to_string(length - 4), "/bufferViews/6");  // planes are last
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

TEST_CASE("wrong values in a buffer are refused with their element") {
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
  poke(attributes["_PLANES"].get<int>(), 4, std::uint16_t(3));  // a duplicate plane
  poke(document.at(Json::json_pointer(kExtension + "/cells/0/ecc/1")).get<int>(), 0, 1.5f);
  poke(attributes["POSITION"].get<int>(), 4, 1e6f);
  const auto points = document["accessors"][0]["count"].get<std::uint16_t>();
  poke(document["meshes"][0]["primitives"][0]["indices"].get<int>(), 7, points);
  poke(document["meshes"][0]["primitives"][1]["indices"].get<int>(), 0, std::uint16_t(65535));
  // Evidence of the backdrop.
  const int backdrop = document.at(Json::json_pointer(kExtension + "/backdrops/0/mesh")).get<int>();
  const std::string backdropAt = "/meshes/" + std::to_string(backdrop) + "/primitives/0/attributes";
  const Json& evidence = document.at(Json::json_pointer(backdropAt));
  const std::string consensus = "/accessors/" + std::to_string(evidence["_CONSENSUS"].get<int>()),
                    confirmations = "/accessors/" + std::to_string(evidence["_CONFIRMATIONS"].get<int>());
  refuse(confirmations + "/componentType", "5123");
  refuse(confirmations + "/count", "3");
  refuse(consensus + "/count", "3");
  for (const char* attribute : {"_CONSENSUS", "_CONFIRMATIONS"}) refuseWithout(backdropAt + "/" + attribute);
  const std::size_t buffer =
      document["bufferViews"][document.at(Json::json_pointer(consensus + "/bufferView")).get<std::size_t>()]["buffer"];
  const fs::path file = example().folder / document["buffers"][buffer]["uri"].get<std::string>();
  const std::vector<std::byte> kept = readFile(file);
  for (const float wrong : {nan, -0.25f, 1.25f}) {
    std::vector<std::byte> bytes = kept;
    std::memcpy(&bytes.at(start(evidence["_CONSENSUS"].get<int>()) + 2 * sizeof wrong), &wrong, sizeof wrong);
    writeFile(file, bytes);
    CHECK_THAT(refusal(example().folder.path(), consensus).message, Catch::Contains("element 2"));
  }
  writeFile(file, kept);
  // Swapped members contradict the derived positions.
  Json swapped = document;
  swapped.at(Json::json_pointer(kExtension + "/cells/1/members")) = {0, 2, 1};
  example().write(swapped);
  CHECK_THAT(refusal(example().folder.path()).message, Catch::Contains("element 0"));
  example().restore();
}

TEST_CASE("the error for a truncated, missing or special buffer file names the file") {
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
  CHECK(refusal(example().folder.path(), "/buffers/0/uri").code == ErrorCode::invalidInput);
  fs::remove(file);
  // A longer file is allowed, because glTF pads.
  std::vector<std::byte> longer = good;
  longer.resize(good.size() + 3);
  writeFile(file, longer);
  CHECK_NOTHROW(loadScene(example().folder.path()));
  writeFile(file, good);
}

TEST_CASE("references outside of the scene's folder are refused", "[P1]") {
  fs::create_directory_symlink("/etc", example().folder / "link");
  for (const std::string pointer :
       {"/buffers/0/uri", "/images/0/uri", "/extensions/IBR_image_graph/photographs/0/texture/uri",
        "/extensions/IBR_image_graph/photographs/0/depth/uri"})
    for (const std::string uri :
         {"../x", "cells/../../x", "/etc/passwd", "file:///etc/passwd", "http://localhost/x", "data:,x", "link/passwd",
          "%2e%2e/x", "..%2Fx", "%2Fetc%2Fpasswd", "", ".", "a%00b", "a%2", "C:\\x", "..\\x"})
      refuse(pointer, jsonLine(Json(uri)));
  fs::remove(example().folder / "link");
  // Names that only resemble a parent folder are allowed.
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

TEST_CASE("validation finds missing and mismatched textures") {
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
  const fs::path depth = example().folder / "depth/view0.ktx2";
  const std::vector<std::byte> goodDepth = readFile(depth);
  const std::string depthPlace = kExtension + "/photographs/0/depth";
  writeKtx2(texture, readKtx2(depth));
  {
    const std::vector<Fault> faults = validateSceneFiles(example().folder.path());
    REQUIRE(faults.size() == 2);  // one for its size as well
    for (const Fault& fault : faults) CHECK(fault.field == place);
    CHECK_THAT(faults[1].message, Catch::Contains("view1.ktx2") && Catch::Contains("rg16f"));
  }
  writeFile(texture, good);
  fs::remove(depth);
  found(depthPlace, "view0.ktx2");
  writeFile(depth, good);
  found(depthPlace, "rgba8");
  Texture wrong;
  wrong.format = TextureFormat::rg16f;
  wrong.width = wrong.height = 2;
  wrong.levels = {std::vector<std::byte>(16), std::vector<std::byte>(4)};
  writeKtx2(depth, wrong);
  found(depthPlace, "2 levels");
  wrong.width = 97;
  wrong.height = 1;
  wrong.levels = {std::vector<std::byte>(97 * 4)};
  writeKtx2(depth, wrong);
  found(depthPlace, "97x1");
  writeFile(depth, goodDepth);
  Json without = example().document;
  without.at(Json::json_pointer(kExtension + "/photographs/0")).erase("texture");
  example().write(without);
  found(kExtension + "/photographs/0", "texture");
  example().restore();
}

TEST_CASE("random changes of bytes give an error or a valid scene", "[P1]") {
  const std::string document = jsonLine(example().document);
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
