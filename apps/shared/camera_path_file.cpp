// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "base/check.h"
#include "base/file.h"
#include "shared/camera_path.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kVersion = 1;
constexpr std::uint64_t kLargestFile = 64 << 20;
constexpr int kDeepest = 8;
constexpr double kLargestNumber = 1e15;
constexpr double kLongest = 24 * 3600.0, kFastest = 1000;  // s, frames a second
constexpr double kMostFrames = 1e6;

// One value of the file, and what messages call it.
class Value {
 public:
  Value(const Json& json, std::string place) : json_(json), place_(std::move(place)) {}

  Value at(const char* key) const {
    wanted(json_.is_object() && json_.contains(key), "an object with \"{}\"", key);
    return {json_[key], place_ + '/' + key};
  }
  Value at(std::size_t i) const { return {json_[i], fmt::format("{}/{}", place_, i)}; }
  std::size_t size(std::size_t least, std::size_t most) const {
    wanted(json_.is_array() && json_.size() >= least && json_.size() <= most, "an array of {} to {} values", least,
           most);
    return json_.size();
  }
  double number(double low, double high) const {
    const double value = json_.is_number() ? json_.get<double>() : std::nan("");
    wanted(value >= low && value <= high, "a number from {} to {}", low, high);
    return value;
  }
  int integer(int low, int high) const {
    const double value = number(low, high);
    wanted(value == std::floor(value), "a whole number");
    return int(value);
  }

  template <class... Args>
  void wanted(bool holds, fmt::format_string<Args...> what, Args&&... args) const {
    if (holds) return;
    std::string text = json_.dump(-1, ' ', true, Json::error_handler_t::replace);
    if (text.size() > 60) text = text.substr(0, 57) + "...";
    fail(ErrorCode::invalidInput, "{}: is {}, but must be {}", place_, text,
         fmt::format(what, std::forward<Args>(args)...));
  }

 private:
  const Json& json_;
  std::string place_;
};

// nlohmann keeps the last of two equal keys; we take neither. Depth is capped while parsing, before anything recurses.
Json parse(const std::string& text, const std::string& name) {
  std::vector<std::vector<std::string>> open;
  const auto watch = [&](int depth, Json::parse_event_t event, Json& value) {
    check(depth <= kDeepest, ErrorCode::invalidInput, "{}: nested more than {} deep", name, kDeepest);
    if (event == Json::parse_event_t::object_start) open.emplace_back();
    if (event == Json::parse_event_t::object_end) open.pop_back();
    if (event == Json::parse_event_t::key) {
      const auto& key = value.get_ref<const std::string&>();
      check(std::ranges::find(open.back(), key) == open.back().end(), ErrorCode::invalidInput,
            "{}: \"{}\" stands twice", name, key);
      open.back().push_back(key);
    }
    return true;
  };
  try {
    return Json::parse(text, watch);
  } catch (const Json::exception& e) {
    fail(ErrorCode::invalidInput, "{}: is not JSON: {}", name, e.what());
  }
}

glm::dvec3 positionOf(const Value& value) {
  value.size(3, 3);
  const auto number = [&](std::size_t i) { return value.at(i).number(-kLargestNumber, kLargestNumber); };
  return {number(0), number(1), number(2)};
}

glm::dquat rotationOf(const Value& value) {
  value.size(4, 4);
  const auto number = [&](std::size_t i) { return value.at(i).number(-1.001, 1.001); };
  const glm::dquat q(number(3), number(0), number(1), number(2));
  value.wanted(std::abs(glm::length(q) - 1.0) < 1e-3, "a unit quaternion x, y, z, w");
  return glm::normalize(q);
}

}  // namespace

CameraPath readCameraPath(const std::filesystem::path& file) {
  const std::string name = file.string();
  const Json json = parse(readTextFile(file, kLargestFile), name);
  const Value root(json, name + ": ");
  root.at("version").integer(kVersion, kVersion);
  CameraPath path;
  const Value size = root.at("size");
  size.size(2, 2);
  path.width = size.at(std::size_t(0)).integer(1, 65536);
  path.height = size.at(std::size_t(1)).integer(1, 65536);
  path.fps = root.at("fps").number(1e-3, kFastest);
  const Value keys = root.at("keys");
  const std::size_t count = keys.size(1, 1'000'000);
  for (std::size_t i = 0; i < count; ++i) {
    const Value key = keys.at(i);
    const Value time = key.at("time");
    path.keys.push_back({time.number(-kLongest, kLongest), positionOf(key.at("position")),
                         rotationOf(key.at("rotation")), key.at("fovY").number(1e-3, std::numbers::pi - 1e-3)});
    if (i > 0) time.wanted(path.keys[i].time - path.keys[i - 1].time >= 1e-6, "later than the key before");
  }
  const double frameCount = (path.keys.back().time - path.keys.front().time) * path.fps;
  keys.wanted(frameCount <= kMostFrames, "at most {} frames", kMostFrames);
  return path;
}

void writeCameraPath(const std::filesystem::path& file, const CameraPath& path) {
  Json json{{"version", kVersion}, {"size", {path.width, path.height}}, {"fps", path.fps}, {"keys", Json::array()}};
  for (const CameraKey& key : path.keys)
    json["keys"].push_back({{"time", key.time},
                            {"position", {key.position.x, key.position.y, key.position.z}},
                            {"rotation", {key.rotation.x, key.rotation.y, key.rotation.z, key.rotation.w}},
                            {"fovY", key.fovY}});
  writeFile(file, json.dump(1) + '\n');
}

}  // namespace ibr::app
