// SPDX-License-Identifier: Apache-2.0
#include "batch/build/build_sources.h"

#include <fmt/format.h>

#include <set>

#include "base/check.h"
#include "base/file.h"
#include "ibr/author/video.h"
#include "shared/cli/progress.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

// "walk" for walk.mp4 and for the folder walk/; a second one is "walk-2".
std::string nameFor(const fs::path& source, std::set<std::string>& used) {
  const fs::path path = fs::weakly_canonical(source);
  const std::string name = fs::is_directory(path) ? path.filename().string() : path.stem().string();
  std::string unique = name;
  for (int number = 2; !used.insert(unique).second; ++number) unique = fmt::format("{}-{}", name, number);
  return unique;
}

void linkTo(const fs::path& folder, const fs::path& link) {
  std::error_code ignored;
  const fs::path target = fs::canonical(folder);
  if (fs::is_symlink(link) && fs::read_symlink(link, ignored) == target) return;
  fs::remove_all(link, ignored);
  std::error_code error;
  fs::create_directory_symlink(target, link, error);
  check(!error, ErrorCode::io, "{}: the link cannot be made: {}", link.string(), error.message());
}

void extract(VideoOptions options, const fs::path& video, const fs::path& folder, const Context& context) {
  options.video = video;
  options.folder = folder;
  ProgressLine progress(context);
  const VideoFrames found = extractFrames(options, progress.callback(), context.log());
  std::size_t blurred = 0;
  for (const VideoFrames::Frame& frame : found.chosen) blurred += frame.sharpness < 0.75;
  context.print("{}: {} of {} frames chosen by sharpness and motion{}\n", video.string(), found.chosen.size(),
                found.decoded, blurred > 0 ? fmt::format("; {} are blurred, for want of sharp ones", blurred) : "");
}

}  // namespace

fs::path photographsOf(const std::vector<std::string>& sources, const fs::path& scene, const VideoOptions& options,
                       const Context& context) {
  check(!sources.empty(), ErrorCode::invalidInput, "no folder of photographs and no video is given");
  for (const std::string& source : sources) {
    check(fs::exists(source), ErrorCode::io, "{}: is neither a folder of photographs nor a video: it does not exist",
          source);
    std::error_code missing;
    check(!fs::equivalent(source, scene, missing), ErrorCode::invalidInput,
          "{}: is the folder of the photographs; choose another output folder", source);
  }
  if (sources.size() == 1 && fs::is_directory(sources[0])) return sources[0];
  const fs::path all = scene / ".photographs";
  makeFolders(all);
  std::set<std::string> used;
  for (const std::string& source : sources) {
    const std::string name = nameFor(source, used);
    if (fs::is_directory(source))
      linkTo(source, all / name);
    else
      extract(options, source, all / name, context);
  }
  for (const auto& entry : fs::directory_iterator(all))  // of an earlier build of other sources
    if (!used.contains(entry.path().filename().string())) fs::remove_all(entry.path());
  return sources.size() == 1 ? all / *used.begin() : all;
}

}  // namespace ibr::app
