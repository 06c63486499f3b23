// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "shared/camera/camera_json.h"
#include "shared/camera/camera_path.h"
#include "shared/json/json_field.h"
#include "shared/json/json_text.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kVersion = 1;
constexpr std::uint64_t kMaxFileBytes = 64 << 20;
constexpr int kMaxSidePx = 65536;
constexpr double kMaxSeconds = 24 * 3600.0, kMinKeySpacing = 1e-6;  // s: limits of the duration and of the key spacing
constexpr double kMinFps = 1e-3, kMaxFps = 1000;                    // limits of fps, frames a second
constexpr double kMaxFrames = 1e6;

}  // namespace

CameraPath readCameraPath(const std::filesystem::path& file) {
  const std::string name = file.string();
  const Json json = parseJson(readTextFile(file, kMaxFileBytes), name);
  const JsonField root = JsonField::whole(json, name);
  root.at("version").integer(kVersion, kVersion);
  CameraPath path;
  const JsonField size = root.at("size");
  size.size(2, 2);
  path.width = size.at(std::size_t(0)).integer(1, kMaxSidePx);
  path.height = size.at(std::size_t(1)).integer(1, kMaxSidePx);
  path.fps = root.at("fps").number(kMinFps, kMaxFps);
  const JsonField keys = root.at("keys");
  const std::size_t count = keys.size(1, 1'000'000);
  for (std::size_t i = 0; i < count; ++i) {
    const JsonField key = keys.at(i);
    const JsonField time = key.at("time");
    const Pose pose = poseOf(key);
    path.keys.push_back({time.number(-kMaxSeconds, kMaxSeconds), pose.position, pose.rotation, fovOf(key)});
    if (i > 0) time.wanted(path.keys[i].time - path.keys[i - 1].time >= kMinKeySpacing, "later than the previous key");
  }
  const double frameCount = (path.keys.back().time - path.keys.front().time) * path.fps;
  keys.wanted(frameCount <= kMaxFrames, "keys for at most {} frames", kMaxFrames);
  return path;
}

void checkCameraPath(const CameraPath& path, const std::string& name) {
  const auto wanted = [&](bool holds, const std::string& field, const char* what) {
    check(holds, ErrorCode::invalidInput, "{}: /{}: {}", name, field, what);
  };
  const auto within = [](double value, double low, double high) { return value >= low && value <= high; };
  wanted(within(path.width, 1, kMaxSidePx) && within(path.height, 1, kMaxSidePx), "size", "is not a valid image size");
  wanted(within(path.fps, kMinFps, kMaxFps), "fps", "is out of range");
  wanted(!path.keys.empty(), "keys", "must not be empty");
  for (std::size_t i = 0; i < path.keys.size(); ++i) {
    const CameraKey& key = path.keys[i];
    const std::string field = fmt::format("keys/{}/", i);
    wanted(within(key.time, -kMaxSeconds, kMaxSeconds), field + "time", "is more than a day from 0");
    wanted(i == 0 || key.time - path.keys[i - 1].time >= kMinKeySpacing, field + "time",
           "is not later than the previous key");
    for (int axis = 0; axis < 3; ++axis)
      wanted(std::abs(key.position[axis]) <= kMaxCoordinate, field + "position", "is not finite or too large");
    wanted(std::abs(glm::length(key.rotation) - 1.0) < 1e-3, field + "rotation", "is not a unit quaternion");
    wanted(within(key.fovY, kMinFov, kMaxFov), field + "fovY", "is not a valid field of view");
  }
  wanted((path.keys.back().time - path.keys.front().time) * path.fps <= kMaxFrames, "keys", "give too many frames");
}

void writeCameraPath(const std::filesystem::path& file, const CameraPath& path) {
  Json json{{"version", kVersion}, {"size", {path.width, path.height}}, {"fps", path.fps}, {"keys", Json::array()}};
  for (const CameraKey& key : path.keys) {
    Json& entry = json["keys"].emplace_back(Json{{"time", key.time}});
    addPose(entry, {key.position, key.rotation});
    entry["fovY"] = key.fovY;
  }
  writeFile(file, jsonText(json));
}

}  // namespace ibr::app
