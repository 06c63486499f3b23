// SPDX-License-Identifier: Apache-2.0
#include "batch/tradeoff/tradeoff_inputs.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <span>
#include <thread>

#include "base/check.h"
#include "base/file.h"
#include "base/hash.h"
#include "batch/files/file_hash.h"
#include "batch/files/poses.h"
#include "batch/files/sha256.h"
#include "batch/files/truth.h"
#include "ibr/version.h"
#include "shared/camera/auto_path.h"
#include "shared/json/json_text.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

// Averages shrink × shrink pixels of the truth, and scales the camera.
TradeoffSubject smaller(const TradeoffSubject& whole, int shrink) {
  TradeoffSubject small = whole;
  Intrinsics& k = small.view.camera.intrinsics;
  k.width /= shrink;
  k.height /= shrink;
  for (double* length : {&k.fx, &k.fy, &k.cx, &k.cy}) *length /= shrink;
  small.truth = Image8(k.width, k.height, whole.truth.channels);
  for (int y = 0; y < k.height; ++y)
    for (int x = 0; x < k.width; ++x)
      for (int c = 0; c < whole.truth.channels; ++c) {
        int sum = 0;
        for (int i = 0; i < shrink * shrink; ++i)
          sum += whole.truth.pixel(shrink * x + i % shrink, shrink * y + i / shrink)[std::size_t(c)];
        small.truth.pixel(x, y)[std::size_t(c)] = std::uint8_t((2 * sum + shrink * shrink) / (2 * shrink * shrink));
      }
  return small;
}

// Hash of the names and contents of all files of the scene, sorted by name.
std::string datasetHash(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::ranges::sort(files);
  std::string all;
  for (const fs::path& file : files)
    all += file.lexically_relative(folder).generic_string() + ' ' + sha256(readFile(file)) + '\n';
  return sha256(std::as_bytes(std::span(all.data(), all.size())));
}

std::string processorName() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) return line.substr(std::min(line.size(), line.find(':') + 2));
  return "unknown";
}

}  // namespace

TradeoffBuilds loadTradeoffBuilds(const TradeoffOptions& options) {
  TradeoffBuilds builds{{}, {options.scene}, {}};
  for (const std::string& build : options.builds) {
    const std::size_t at = build.find('=');
    check(at != std::string::npos && at > 0, ErrorCode::invalidInput, "--build {}: must be NAME=SCENE", build);
    builds.names.push_back(build.substr(0, at));
    builds.folders.push_back(build.substr(at + 1));
  }
  for (const std::string& folder : builds.folders) builds.scenes.push_back(loadScene(folder));
  return builds;
}

std::vector<TradeoffSubject> tradeoffSubjects(const TradeoffOptions& options, const Scene& scene,
                                              const Context& context) {
  std::vector<TradeoffSubject> subjects;
  if (!options.truth.empty()) {
    const Truth truth(options.truth, options.only, context.log());
    for (const View& view : truth.views()) subjects.push_back(smaller({view, truth.picture(view)}, options.shrink));
  }
  if (!options.poses.empty())
    for (const View& view : readViews(options.poses, options.size, context.log())) subjects.push_back({view, {}});
  const int automatic = options.autoViews > 0 ? options.autoViews : subjects.empty() ? 5 : 0;
  if (automatic > 0)
    for (const View& view : frames(autoPath(scene, automatic, options.size.width, options.size.height)))
      subjects.push_back({view, {}});
  return subjects;
}

std::vector<View> tradeoffWalk(const TradeoffOptions& options, const Scene& scene,
                               const std::vector<TradeoffSubject>& subjects) {
  if (options.walk <= 0) return {};
  const Intrinsics& k = subjects[0].view.camera.intrinsics;
  return frames(autoPath(scene, options.walk, k.width, k.height));
}

VkExtent2D maxExtentOf(const std::vector<TradeoffSubject>& subjects, const std::vector<View>& walk) {
  VkExtent2D largest{1, 1};
  const auto grow = [&](const Camera& camera) {
    largest.width = std::max(largest.width, std::uint32_t(camera.intrinsics.width));
    largest.height = std::max(largest.height, std::uint32_t(camera.intrinsics.height));
  };
  for (const TradeoffSubject& subject : subjects) grow(subject.view.camera);
  for (const View& view : walk) grow(view.camera);
  return largest;
}

nlohmann::ordered_json readSweepReport(const std::string& file) {
  if (file.empty()) return nullptr;
  const nlohmann::ordered_json json = jsonOrDiscarded(readTextFile(file));
  const bool good = json.is_object() && json.contains("settings") && json["settings"].is_array() &&
                    std::ranges::all_of(json["settings"], [](const nlohmann::ordered_json& row) {
                      return row.is_object() && row.contains("method") && row["method"].is_string() &&
                             row.contains("setting") && row["setting"].is_string() && row.contains("seconds") &&
                             row.contains("ecc") && row.contains("scores") && row["scores"].is_object() &&
                             row["scores"].contains("psnrCovered");
                    });
  check(good, ErrorCode::invalidInput, "{}: is not a report of ibr-lab sweep (--sweep)", file);
  return json;
}

std::uint64_t tradeoffKey(const TradeoffOptions& options, const TradeoffBuilds& builds,
                          const std::vector<TradeoffSubject>& subjects, const Device& device, const Context& context) {
  Hash hash;
  addProgram(hash);
  for (const std::string& folder : builds.folders) addFolder(hash, folder);
  for (const auto& [view, truth] : subjects) {
    const Pose& pose = view.camera.pose;
    const Intrinsics& k = view.camera.intrinsics;
    hash.add(view.name);
    for (const double number :
         {pose.position.x, pose.position.y, pose.position.z, pose.rotation.w, pose.rotation.x, pose.rotation.y,
          pose.rotation.z, double(k.width), double(k.height), k.fx, k.fy, k.cx, k.cy})
      hash.add(number);
    hash.add(std::as_bytes(std::span(truth.values)));
  }
  hash.add(device.name());
  hash.add(std::int64_t(context.options().threads));
  hash.add(std::int64_t(options.walk));
  return hash.value();
}

nlohmann::ordered_json tradeoffAbout(const TradeoffOptions& options, const TradeoffBuilds& builds,
                                     const std::vector<TradeoffSubject>& subjects, const Device& device,
                                     const Context& context) {
  const VkPhysicalDeviceLimits& limits = device.properties().limits;
  const bool software = device.kind() == DeviceKind::software;
  nlohmann::ordered_json views = nlohmann::ordered_json::array();
  for (const auto& [view, truth] : subjects)
    views.push_back({{"name", view.name},
                     {"size", {view.camera.intrinsics.width, view.camera.intrinsics.height}},
                     {"truth", !truth.empty()}});
  return {
      {"libibr", version()},
      {"scene", options.scene},
      {"dataset", datasetHash(options.scene)},
      {"builds", builds.names},
      {"truth", options.truth},
      {"shrink", options.shrink},
      {"views", views},
      {"device", device.name()},
      {"software", software},
      {"processor", processorName()},
      {"cores", std::thread::hardware_concurrency()},
      {"limits",
       {{"subTexelPrecisionBits", limits.subTexelPrecisionBits},
        {"mipmapPrecisionBits", limits.mipmapPrecisionBits},
        {"timestampPeriodNs", limits.timestampPeriod}}},
      {"clock",
       "planning: the host's steady clock; drawing: the device's timestamps, from the first command of a frame to the "
       "last, without the copy to the host"},
      {"seed", context.options().seed},
      {"warmUp", 1},
      {"repeat", options.repeat},
      {"order", "interleaved: each round measures all settings once, in random order"},
      {"command", options.command}};
}

}  // namespace ibr::app
