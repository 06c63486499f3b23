// SPDX-License-Identifier: Apache-2.0
#include "spoilt_scene.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "example_scene.h"
#include "ibr/scene.h"
#include "support/json.h"

namespace fs = std::filesystem;

namespace ibr::test {

Example::Example() {
  writeExampleScene(folder.path());
  document = parseJson(readTextFile(folder / "scene.gltf"));
}

void Example::write(const Json& json) const {
  writeFile(folder / "scene.gltf", jsonLine(json));
}

fs::path Example::bufferOf(std::size_t cell) const {
  return folder / document["buffers"][cell]["uri"].get<std::string>();
}

Example& example() {
  static Example instance;
  return instance;
}

Refusal refusal(const fs::path& path, const std::string& place) {
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

void refuse(const std::string& pointer, const std::string& text, std::string place) {
  if (place.empty()) place = pointer;
  INFO(pointer << " = " << text << ", expected at " << place);
  Json wrong = example().document;
  wrong[Json::json_pointer(pointer)] = "@";  // inserted as text, because a JSON number type cannot hold every value
  std::string document = jsonLine(wrong);
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

}  // namespace ibr::test
