// SPDX-License-Identifier: Apache-2.0
#include "base/file.h"
#include "shared/camera_json.h"
#include "shared/camera_path.h"
#include "shared/json_field.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kVersion = 1;
constexpr std::uint64_t kLargestFile = 64 << 20;
constexpr double kLongest = 24 * 3600.0, kFastest = 1000;  // s, frames a second
constexpr double kMostFrames = 1e6;

}  // namespace

CameraPath readCameraPath(const std::filesystem::path& file) {
  const std::string name = file.string();
  const Json json = parseJson(readTextFile(file, kLargestFile), name);
  const JsonField root = JsonField::whole(json, name);
  root.at("version").integer(kVersion, kVersion);
  CameraPath path;
  const JsonField size = root.at("size");
  size.size(2, 2);
  path.width = size.at(std::size_t(0)).integer(1, 65536);
  path.height = size.at(std::size_t(1)).integer(1, 65536);
  path.fps = root.at("fps").number(1e-3, kFastest);
  const JsonField keys = root.at("keys");
  const std::size_t count = keys.size(1, 1'000'000);
  for (std::size_t i = 0; i < count; ++i) {
    const JsonField key = keys.at(i);
    const JsonField time = key.at("time");
    const Pose pose = poseOf(key);
    path.keys.push_back({time.number(-kLongest, kLongest), pose.position, pose.rotation, fovOf(key)});
    if (i > 0) time.wanted(path.keys[i].time - path.keys[i - 1].time >= 1e-6, "later than the key before");
  }
  const double frameCount = (path.keys.back().time - path.keys.front().time) * path.fps;
  keys.wanted(frameCount <= kMostFrames, "at most {} frames", kMostFrames);
  return path;
}

void writeCameraPath(const std::filesystem::path& file, const CameraPath& path) {
  Json json{{"version", kVersion}, {"size", {path.width, path.height}}, {"fps", path.fps}, {"keys", Json::array()}};
  for (const CameraKey& key : path.keys) {
    Json& entry = json["keys"].emplace_back(Json{{"time", key.time}});
    addPose(entry, {key.position, key.rotation});
    entry["fovY"] = key.fovY;
  }
  writeFile(file, json.dump(1) + '\n');
}

}  // namespace ibr::app
