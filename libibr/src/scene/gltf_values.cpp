// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf_values.h"

#include <cmath>

namespace ibr {

double positive(const JsonValue& value) {
  const double number = value.number();
  if (!(number > 0)) value.fault(fmt::format("{} is not positive", number));
  return number;
}

double within(const JsonValue& value, double low, double high) {
  const double number = value.number();
  if (!(number >= low && number <= high)) value.fault(fmt::format("{} is not within {} to {}", number, low, high));
  return number;
}

glm::dvec3 vector3(const JsonValue& value) {
  if (value.size() != 3) value.fault("is not a list of three numbers");
  return {value.at(0).number(), value.at(1).number(), value.at(2).number()};
}

glm::dquat quaternion(const JsonValue& value) {
  if (value.size() != 4) value.fault("is not a list of four numbers");
  const glm::dquat q(value.at(3).number(), value.at(0).number(), value.at(1).number(), value.at(2).number());
  const double length = glm::length(q);
  if (!(std::abs(length - 1.0) <= 1e-3)) value.fault(fmt::format("has length {}, not 1", length));
  // An exact unit quaternion stays unchanged, so that saved values load bit for bit.
  return std::abs(length - 1.0) <= 1e-15 ? q : q / length;
}

Intrinsics intrinsicsOf(const JsonValue& json) {
  Intrinsics k;
  const std::string model = json["model"].string();
  if (model != "PINHOLE" && model != "EQUIRECTANGULAR")
    json["model"].fault(fmt::format("\"{}\" is neither PINHOLE nor EQUIRECTANGULAR", model));
  k.width = int(json["width"].integer(1, 1 << 16));
  k.height = int(json["height"].integer(1, 1 << 16));
  if (model == "EQUIRECTANGULAR") {
    k.model = CameraModel::equirectangular;
    return k;
  }
  k.fx = positive(json["fx"]);
  k.fy = positive(json["fy"]);
  k.cx = json["cx"].number();
  k.cy = json["cy"].number();
  return k;
}

void checkVersion(const JsonValue& json, const SupportedVersions& supported) {
  const JsonValue version = json["version"];
  const auto number = version.integer(1, INT32_MAX);
  if (number > supported.newest)
    version.fault(
        fmt::format("{} is newer than {}, the newest version that this library reads", number, supported.newest));
  if (number < supported.oldest)
    version.fault(fmt::format("{} is older than {}, the oldest version that this library reads; {}", number,
                              supported.oldest, supported.remedy));
}

JsonValue extensionOf(const GltfDocument& document, const char* name, const SupportedVersions& supported) {
  const JsonValue extension = document.root()["extensions"][name];
  checkVersion(extension, supported);
  return extension;
}

NamedCamera namedCamera(const GltfDocument& document, const JsonValue& entry) {
  NamedCamera result;
  const JsonValue json = document.element("nodes", entry["node"]);
  if (document.hasParent(json))
    entry["node"].fault(fmt::format("{} is a child of another node; a photograph needs a root node", json.pointer()));
  result.name = json["name"].string();
  if (result.name.empty()) json["name"].fault("is empty");
  for (const char* key : {"matrix", "scale"})
    if (json.has(key)) json[key].fault("is not allowed: a camera has only a translation and a rotation");
  if (json.has("translation")) result.camera.pose.position = vector3(json["translation"]);
  if (json.has("rotation")) result.camera.pose.rotation = quaternion(json["rotation"]);
  result.camera.intrinsics = intrinsicsOf(entry["camera"]);
  return result;
}

std::filesystem::path documentFile(const std::filesystem::path& path, const char* name) {
  std::error_code ignored;
  return std::filesystem::is_directory(path, ignored) ? path / name : path;
}

}  // namespace ibr
