// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "author/video/frame_choice.h"
#include "author/video/video_file.h"
#include "base/check.h"
#include "base/file.h"
#include "ibr/author/video.h"
#include "io/image_file.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

constexpr int kVersion = 1;         // of the choice: raise it when chosen frames change
constexpr int kMeasuredSide = 960;  // longer side of the measured frames, px
constexpr int kJpegQuality = 95;
constexpr const char* kIndexName = ".video.json";

std::string keyOf(const VideoOptions& options) {
  const auto time = fs::last_write_time(options.video).time_since_epoch().count();
  return fmt::format("{} {} {} {} {} {}", kVersion, fs::weakly_canonical(options.video).string(),
                     fs::file_size(options.video), time, options.frames, options.keepMetadata);
}

std::string frameName(const fs::path& video, std::size_t number) {
  return fmt::format("{}_{:06}.jpg", video.stem().string(), number);
}

// The frames of an earlier call, if all are there.
bool isFinished(const VideoOptions& options, VideoFrames& frames) {
  std::error_code ignored;
  if (!fs::is_regular_file(options.folder / kIndexName, ignored)) return false;
  const Json json = Json::parse(readTextFile(options.folder / kIndexName), nullptr, false);
  if (!json.is_object() || json.value("key", "") != keyOf(options) || !json.contains("frames")) return false;
  frames.decoded = json.value("decoded", std::size_t(0));
  for (const Json& frame : json.at("frames")) {
    const std::size_t number = frame.at("number");
    frames.chosen.push_back({frameName(options.video, number), number, frame.at("sharpness")});
    if (!fs::is_regular_file(options.folder / frames.chosen.back().name, ignored)) return false;
  }
  return !frames.chosen.empty();
}

// Removes the index and frames of an earlier choice, by their names: the folder may hold other files.
void removeFrames(const VideoOptions& options) {
  std::error_code ignored;
  fs::remove(options.folder / kIndexName, ignored);
  const std::string begin = options.video.stem().string() + '_', end = ".jpg";
  for (const auto& entry : fs::directory_iterator(options.folder)) {
    const std::string name = entry.path().filename().string();
    const bool fits = name.size() >= begin.size() + 6 + end.size() && name.starts_with(begin) && name.ends_with(end);
    const auto number = fits ? name.substr(begin.size(), name.size() - begin.size() - end.size()) : std::string();
    if (fits && number.find_first_not_of("0123456789") == number.npos) fs::remove(entry.path(), ignored);
  }
}

void writeIndex(const VideoOptions& options, const VideoFrames& frames) {
  Json json{{"key", keyOf(options)}, {"decoded", frames.decoded}, {"frames", Json::array()}};
  for (const VideoFrames::Frame& frame : frames.chosen)
    json["frames"].push_back({{"number", frame.number}, {"sharpness", frame.sharpness}});
  writeFile(options.folder / kIndexName, json.dump(1) + "\n");
}

std::vector<FrameMeasure> measured(const VideoFile& file, const VideoInfo& info, int width, int height,
                                   const ProgressCallback& progress) {
  const auto expected = std::size_t(std::lround(info.seconds * info.framesPerSecond));
  FrameMeasurer measurer(info.framesPerSecond);
  std::vector<FrameMeasure> measures;
  file.greyFrames(width, height, [&](std::size_t number, const Image8& frame) {
    measures.push_back(measurer.measure(frame));
    return !progress || progress({"choosing frames of the video", number + 1, std::max(expected, number + 1)});
  });
  return measures;
}

// What is told of a video before it is decoded.
std::string describe(const VideoInfo& info) {
  std::string text = fmt::format("{}x{} px, {:.3g} frames a second", info.width, info.height, info.framesPerSecond);
  if (info.variableRate) text += " (variable)";
  if (info.rotation != 0) text += fmt::format(", turned by {}°", info.rotation);
  if (info.hdr) text += ", HDR, which is compressed";
  if (info.location) text += ", location kept in the frames";
  if (!info.ignored.empty()) text += fmt::format("; ignored: {}", fmt::join(info.ignored, ", "));
  return text;
}

}  // namespace

VideoFrames extractFrames(const VideoOptions& options, const ProgressCallback& progress, const LogCallback& log) {
  const VideoStream stream = probeStream(options.video, options.ffprobe);
  VideoFrames frames;
  frames.info = stream.info;
  if (log) log(LogLevel::info, fmt::format("{}: {}", options.video.string(), describe(stream.info)));
  if (isFinished(options, frames)) return frames;
  frames.chosen.clear();
  makeFolders(options.folder);
  removeFrames(options);
  const VideoFile file(options.video, stream, options.ffmpeg);
  const double scale = std::min(1.0, double(kMeasuredSide) / std::max(stream.info.width, stream.info.height));
  const int width = std::max(16, int(std::lround(scale * stream.info.width)));
  const int height = std::max(16, int(std::lround(scale * stream.info.height)));
  const std::vector<FrameMeasure> measures = measured(file, stream.info, width, height, progress);
  frames.decoded = measures.size();
  const MeasuredVideo video{measures, width, height, stream.info.framesPerSecond};
  const std::vector<double> sharpness = relativeSharpness(video);
  const std::vector<std::size_t> numbers = chooseFrames(video, sharpness, options.frames);
  std::size_t done = 0;
  file.colourFrames(numbers, [&](std::size_t number, const Image8& picture) {
    const std::string name = frameName(options.video, number);
    if (options.keepMetadata)
      writePhotograph(options.folder / name, picture, kJpegQuality, stream.info.capture, stream.info.location);
    else
      writeImage(options.folder / name, picture, kJpegQuality);
    frames.chosen.push_back({name, number, sharpness[number]});
    return !progress || progress({"writing frames of the video", ++done, numbers.size()});
  });
  writeIndex(options, frames);
  return frames;
}

}  // namespace ibr
