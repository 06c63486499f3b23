// SPDX-License-Identifier: Apache-2.0
#include "shared/camera/camera_json.h"

#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kMaxSidePx = 65536;

// Turns −0 into 0, so that one view has one text.
double plain(double value) {
  return value + 0.0;
}

}  // namespace

glm::dquat unitRotation(const glm::dquat& rotation) {
  return std::abs(glm::dot(rotation, rotation) - 1.0) < 1e-14 ? rotation : glm::normalize(rotation);
}

void addPose(Json& json, const Pose& pose) {
  const auto& [p, q] = pose;
  json["position"] = {plain(p.x), plain(p.y), plain(p.z)};
  json["rotation"] = {plain(q.x), plain(q.y), plain(q.z), plain(q.w)};
}

Pose poseOf(const JsonField& object) {
  const JsonField position = object.at("position");
  position.size(3, 3);
  const auto coordinate = [&](std::size_t i) { return position.at(i).number(-kMaxCoordinate, kMaxCoordinate); };
  const glm::dvec3 p(coordinate(0), coordinate(1), coordinate(2));
  const JsonField rotation = object.at("rotation");
  rotation.size(4, 4);
  const auto number = [&](std::size_t i) { return rotation.at(i).number(-1.001, 1.001); };
  const glm::dquat q(number(3), number(0), number(1), number(2));
  rotation.wanted(std::abs(glm::length(q) - 1.0) < 1e-3, "a unit quaternion x, y, z, w");
  return {p, unitRotation(q)};
}

double fovOf(const JsonField& object) {
  return object.at("fovY").number(kMinFov, kMaxFov);
}

Json intrinsicsJson(const Intrinsics& k) {
  const bool pinhole = k.model == CameraModel::pinhole;
  Json json{{"model", pinhole ? "pinhole" : "equirectangular"}, {"width", k.width}, {"height", k.height}};
  if (pinhole)
    for (const auto& [name, value] : {std::pair{"fx", k.fx}, {"fy", k.fy}, {"cx", k.cx}, {"cy", k.cy}})
      json[name] = plain(value);
  return json;
}

Intrinsics intrinsicsOf(const JsonField& object) {
  const JsonField model = object.at("model");
  const std::string word = model.text();
  model.wanted(word == "pinhole" || word == "equirectangular", "\"pinhole\" or \"equirectangular\"");
  Intrinsics k;
  k.width = object.at("width").integer(1, kMaxSidePx);
  k.height = object.at("height").integer(1, kMaxSidePx);
  if (word == "equirectangular") {
    k.model = CameraModel::equirectangular;
    return k;
  }
  k.fx = object.at("fx").number(1e-9, kMaxCoordinate);
  k.fy = object.at("fy").number(1e-9, kMaxCoordinate);
  k.cx = object.at("cx").number(-kMaxCoordinate, kMaxCoordinate);
  k.cy = object.at("cy").number(-kMaxCoordinate, kMaxCoordinate);
  return k;
}

}  // namespace ibr::app
