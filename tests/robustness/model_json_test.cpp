// SPDX-License-Identifier: Apache-2.0
// model.gltf and its buffers with one fault at a time: loadHtmModel throws an Error that names file and JSON pointer,
// and validateHtmModelFiles reports the fault. No other outcome is allowed.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstring>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "example_model.h"
#include "support/error_of.h"
#include "support/json.h"
#include "support/temporary_folder.h"

namespace fs = std::filesystem;
using namespace ibr;
using namespace ibr::test;

namespace {

using Json = nlohmann::json;

const std::string kExtension = "/extensions/IBR_harmonised_texture";

struct Example {
  TemporaryFolder folder;
  Json document;
  Example() {
    writeExampleModel(folder.path());
    document = parseJson(readTextFile(folder / "model.gltf"));
  }
  void write(const Json& json) const { writeFile(folder / "model.gltf", jsonLine(json)); }
};

void expectRefused(const Example& example, const std::string& place) {
  const std::vector<Fault> faults = validateHtmModelFiles(example.folder.path());
  CHECK(std::any_of(faults.begin(), faults.end(), [&](const Fault& f) { return f.field == place; }));
  const Error error = errorOf([&] { loadHtmModel(example.folder.path()); });
  CHECK(error.code() == ErrorCode::invalidInput);
  CHECK_THAT(error.what(), Catch::Contains("model.gltf") && Catch::Contains(place));
}

void refuse(const Example& example, const std::string& pointer, const Json& value, std::string place = {}) {
  if (place.empty()) place = pointer;
  INFO(pointer << " = " << value << ", expected at " << place);
  Json wrong = example.document;
  wrong[Json::json_pointer(pointer)] = value;
  example.write(wrong);
  expectRefused(example, place);
  example.write(example.document);
}

void refuseWithout(const Example& example, const std::string& pointer) {
  const Json::json_pointer whole(pointer);
  INFO(pointer << " is missing");
  Json wrong = example.document;
  wrong.at(whole.parent_pointer()).erase(whole.back());
  example.write(wrong);
  expectRefused(example, whole.parent_pointer().to_string());
  example.write(example.document);
}

template <class T>
void refuseBytes(const Example& example, std::size_t buffer, std::size_t offset, T value, const std::string& place) {
  const fs::path file = example.folder / example.document["buffers"][buffer]["uri"].get<std::string>();
  const std::string before = readTextFile(file);
  std::string bytes = before;
  std::memcpy(&bytes.at(offset), &value, sizeof value);
  writeFile(file, bytes);
  expectRefused(example, place);
  writeFile(file, before);
}

}  // namespace

TEST_CASE("the example model is valid") {
  const Example example;
  for (const Fault& fault : validateHtmModelFiles(example.folder.path())) FAIL(fault.field << " " << fault.message);
  const HtmModel model = loadHtmModel(example.folder.path());
  CHECK(model.complements == exampleModel().complements);
  CHECK(model.surface.members == exampleModel().surface.members);
  CHECK(model.surface.mesh == exampleModel().surface.mesh);
}

TEST_CASE("wrong values of a model and paths outside of its folder are refused") {
  const Example example;
  for (const std::string pointer : {"/version", "/cameras/0/node", "/cameras/1/image", "/cameras/0/camera/width",
                                    "/surface/node", "/source/node", "/complements"})
    for (const Json& value :
         {Json(-1), Json(3.5), Json("0"), Json(nullptr), Json::array(), Json::object(), Json(4294967296)})
      refuse(example, kExtension + pointer, value);
  refuse(example, kExtension + "/version", 2);
  refuse(example, kExtension + "/cameras/0/camera/fx", 0);
  refuse(example, kExtension + "/cameras/0/camera/model", "FISHEYE");
  refuse(example, kExtension + "/cameras/0/camera/model", "EQUIRECTANGULAR");
  refuse(example, kExtension + "/cameras/1/node", 0);  // a duplicate name
  refuse(example, kExtension + "/cameras/0/visibility/uri", "../up.png");
  refuse(example, kExtension + "/cameras", Json::array());
  refuse(example, kExtension + "/cameras",
         Json(65, example.document["extensions"]["IBR_harmonised_texture"]["cameras"][0]));
  refuse(example, "/nodes/2/rotation", {0, 0, 0, 1});
  refuse(example, "/nodes/2/scale", {1, 1, 1});
  refuse(example, "/nodes/2/translation", {0, 0});
  refuse(example, "/nodes/0/children", {2}, kExtension + "/surface/node");
  refuse(example, "/meshes/0/primitives/0/mode", 1);
  refuse(example, "/meshes/0/primitives", Json::array());
  const std::string primitive = "/meshes/0/primitives/0";
  const auto accessor = [&](const std::string& at) {
    return "/accessors/" + std::to_string(example.document[Json::json_pointer(at)].get<int>());
  };
  const std::string position = accessor(primitive + "/attributes/POSITION"),
                    members = accessor(primitive + "/attributes/_MEMBERS"), indices = accessor(primitive + "/indices"),
                    complements = accessor(kExtension + "/complements");
  refuse(example, position + "/componentType", 5123);
  refuse(example, position + "/count", 9, position);
  refuse(example, members + "/count", 7);
  refuse(example, members + "/type", "VEC2");
  refuse(example, indices + "/count", 35);
  refuse(example, indices + "/componentType", 5126);
  refuse(example, complements + "/count", 31);
  refuse(example, complements + "/type", "VEC3");
  const float nan = std::numeric_limits<float>::quiet_NaN();
  refuseBytes(example, 0, 4, nan, position);
  refuseBytes(example, 0, 8 * 12, std::uint16_t(4), members);
  refuseBytes(example, 0, 8 * 12 + 6, std::uint16_t(0x8000), members);
  refuseBytes(example, 0, 8 * 12 + 8 * 8, std::uint16_t(8), indices);
  refuseBytes(example, 1, 12, nan, complements);
}

TEST_CASE("missing members of a model are refused") {
  const Example example;
  for (const std::string pointer :
       {"", "/version", "/cameras", "/surface", "/surface/node", "/cameras/0/node", "/cameras/0/camera",
        "/cameras/0/camera/model", "/cameras/0/camera/cx", "/cameras/0/visibility/uri"})
    refuseWithout(example, kExtension + pointer);
  for (const std::string pointer :
       {"/nodes/0/name", "/nodes/2/mesh", "/images/0/uri", "/meshes/0/primitives", "/meshes/0/primitives/0/indices",
        "/meshes/0/primitives/0/attributes/POSITION", "/meshes/0/primitives/0/attributes/_MEMBERS", "/buffers/0/uri"})
    refuseWithout(example, pointer);
}

TEST_CASE("a wrong type of any value in a model's document gives an error or a valid model") {
  const Example example;
  std::vector<std::string> pointers;
  const std::function<void(const Json&, const std::string&)> walk = [&](const Json& value, const std::string& at) {
    if (!at.empty()) pointers.push_back(at);
    if (value.is_object())
      for (const auto& [key, child] : value.items()) walk(child, at + '/' + key);
    if (value.is_array())
      for (std::size_t i = 0; i < value.size(); ++i) walk(value[i], at + '/' + std::to_string(i));
  };
  walk(example.document, "");
  std::size_t refused = 0;
  for (const std::string& pointer : pointers)
    for (const Json& value : {Json(nullptr), Json(-7), Json::array({1})}) {
      Json wrong = example.document;
      wrong[Json::json_pointer(pointer)] = value;
      example.write(wrong);
      INFO(pointer << " = " << value);
      try {
        const HtmModel model = loadHtmModel(example.folder.path());
        REQUIRE(validate(model).empty());
      } catch (const Error& e) {
        ++refused;
        REQUIRE_THAT(e.what(), Catch::Contains("model.gltf: /"));
      }
    }
  CHECK(refused > 300);
}

TEST_CASE("missing images are faults of a model's files") {
  const Example example;
  fs::remove(example.folder / "images/left.png");
  fs::remove(example.folder / "visibility/right.png");
  Json plain = example.document;
  plain[Json::json_pointer(kExtension)]["cameras"][1].erase("image");
  example.write(plain);
  const std::vector<Fault> faults = validateHtmModelFiles(example.folder.path());
  REQUIRE(faults.size() == 3);
  CHECK(faults[0].field == kExtension + "/cameras/0/image");
  CHECK(faults[1].field == kExtension + "/cameras/1");
  CHECK(faults[2].field == kExtension + "/cameras/1/visibility");
  CHECK(validateHtmModelFiles(example.folder.path(), 2).size() == 2);
  CHECK(errorOf([&] { loadHtmModel(example.folder / "nowhere"); }).code() == ErrorCode::io);
}
