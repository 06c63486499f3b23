// SPDX-License-Identifier: Apache-2.0
#include "shared/camera/view_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>
#include <string_view>

#include "shared/camera/camera_json.h"
#include "shared/json/json_text.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxCharacters = 4096;
constexpr const char* kName = "view";
constexpr std::array<std::string_view, 5> kFields{"position", "rotation", "fovY", "up", "time"};

glm::dvec3 directionOf(const JsonField& value) {
  value.size(3, 3);
  const auto number = [&](std::size_t i) { return value.at(i).number(-1.001, 1.001); };
  const glm::dvec3 d(number(0), number(1), number(2));
  value.wanted(std::abs(glm::length(d) - 1.0) < 1e-3, "a unit vector");
  return std::abs(glm::dot(d, d) - 1.0) < 1e-14 ? d : glm::normalize(d);
}

}  // namespace

std::string viewText(const TextView& view) {
  Json json;
  addPose(json, view.pose);
  json["fovY"] = view.fovY;
  if (view.up) json["up"] = {view.up->x + 0.0, view.up->y + 0.0, view.up->z + 0.0};
  return jsonLine(json);
}

TextView viewOf(const std::string& text) {
  check(text.size() <= kMaxCharacters, ErrorCode::invalidInput, "{}: is longer than {} characters", kName,
        kMaxCharacters);
  const Json json = parseJson(text, kName);
  const JsonField root = JsonField::whole(json, kName);
  TextView view{poseOf(root), fovOf(root), {}};
  if (root.has("up")) view.up = directionOf(root.at("up"));
  if (root.has("time")) root.at("time").number(-1e15, 1e15);
  for (const auto& [key, unused] : json.items())
    check(std::ranges::find(kFields, key) != kFields.end(), ErrorCode::invalidInput, "{}: /{}: unknown field", kName,
          key);
  return view;
}

}  // namespace ibr::app
