// SPDX-License-Identifier: Apache-2.0
#include "viewer/control/job_plans.h"

#include <fmt/format.h>

#include <cctype>
#include <nlohmann/json.hpp>

#include "shared/cli/setting_arguments.h"
#include "viewer/control/screenshot.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

using Words = std::vector<std::string>;

void append(Words& words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
}

bool isPhotograph(const fs::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension) c = char(std::tolower(static_cast<unsigned char>(c)));
  for (const char* known : {".jpg", ".jpeg", ".png", ".tif", ".tiff"})
    if (extension == known) return true;
  return false;
}

// Returns options for poses stored with the photographs (COLMAP model or transforms.json).
Words posesIn(const fs::path& folder) {
  for (const char* model : {"sparse/0", "sparse"})
    for (const char* images : {"images.bin", "images.txt"})
      if (fs::exists(folder / model / images)) return {"--model", (folder / model).string()};
  if (fs::exists(folder / "transforms.json")) return {"--model", (folder / "transforms.json").string()};
  return {};
}

// Returns the options of `ibr render` for the current settings.
Words wordsOf(const OpenItem& item, const GpuSceneOptions& gpuScene) {
  Words words = settingArguments(settingsOf(item, gpuScene));
  if (item.video && !item.playing) append(words, {"--time", fmt::format("{}", item.time)});
  return words;
}

// Returns ffmpeg's input pattern. A % in the folder's name is doubled, because ffmpeg reads % as a frame number.
std::string framesIn(const fs::path& folder) {
  std::string pattern;
  for (const char c : folder.string()) pattern += c == '%' ? "%%" : std::string(1, c);
  return pattern + "/frame_%04d.png";
}

// Crops to even sides: yuv420p, which all players support, needs them.
Words encode(const fs::path& pictures, double fps, const fs::path& video) {
  return {"ffmpeg",      "-v",
          "error",       "-y",
          "-framerate",  fmt::format("{}", fps),
          "-i",          framesIn(pictures),
          "-vf",         "crop=trunc(iw/2)*2:trunc(ih/2)*2",
          "-pix_fmt",    "yuv420p",
          "-crf",        "20",
          "-movflags",   "+faststart",
          video.string()};
}

}  // namespace

bool containsPhotographs(const fs::path& folder) noexcept try {
  constexpr int kMinPhotographs = 2, kMaxEntries = 10000;
  int found = 0, entries = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder, fs::directory_options::skip_permission_denied)) {
    if (++entries > kMaxEntries) return false;
    if (isPhotograph(entry.path()) && ++found == kMinPhotographs) return true;
  }
  return false;
} catch (const fs::filesystem_error&) {
  return false;
}

JobPlan buildPlan(const fs::path& photographs) {
  fs::path folder = fs::absolute(photographs).lexically_normal();
  if (folder.filename().empty()) folder = folder.parent_path();
  const fs::path scene = folder.string() + "-scene";
  Words words{ibrProgram().string(), "build", folder.string(), "-o", scene.string()};
  append(words, posesIn(folder));
  return {
      .name = scene.filename().string(), .steps = {{"starting", std::move(words)}}, .done = {}, .resultScene = scene};
}

JobPlan videoPlan(const OpenItem& item, const fs::path& cameraPath, const GpuSceneOptions& gpuScene,
                  const std::string& device) {
  const fs::path pictures = fs::path(cameraPath).replace_extension(), video = pictures.string() + ".mp4";
  Words render{ibrProgram().string(), "render", item.path.string(), "--poses",
               cameraPath.string(),   "-o",     pictures.string()};
  append(render, wordsOf(item, gpuScene));
  if (!device.empty()) append(render, {"--device", device});
  JobPlan plan{
      .name = video.filename().string(), .steps = {{"starting", std::move(render)}}, .done = {}, .resultScene = {}};
  if (isOnPath("ffmpeg")) {
    const fs::path part = pictures.string() + ".part.mp4";  // temporary name: NAME.mp4 is always complete
    plan.steps.push_back({"ffmpeg encodes the video", encode(pictures, item.cameraPath.fps, part)});
    plan.steps.push_back({"", {"mv", part.string(), video.string()}});
    plan.done = fmt::format("{} written", video.string());
  } else {
    plan.done = fmt::format("{} contains the frames; install ffmpeg to get a video", pictures.string());
  }
  return plan;
}

}  // namespace ibr::app
