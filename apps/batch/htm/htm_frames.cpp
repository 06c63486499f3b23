// SPDX-License-Identifier: Apache-2.0
#include "batch/htm/htm_frames.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "base/file.h"
#include "base/stopwatch.h"
#include "batch/files/file_hash.h"
#include "batch/files/poses.h"
#include "batch/htm/htm_report.h"
#include "ibr/asset.h"
#include "ibr/author/htm.h"
#include "ibr/error.h"
#include "shared/json/json_text.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kBuildFile = "build.json";  // beside a frame's model: key of its inputs, and its report

fs::path meshOf(const fs::path& frame) {
  fs::path found;
  for (const char* name : {"mesh.ply", "mesh.obj", "mesh.gltf", "mesh.glb"}) {
    if (!fs::is_regular_file(frame / name)) continue;
    check(found.empty(), ErrorCode::invalidInput, "{}: is a second mesh of the frame, besides {}; remove one",
          (frame / name).string(), found.filename().string());
    found = frame / name;
  }
  check(!found.empty(), ErrorCode::io, "{}: has no mesh.ply, mesh.obj, mesh.gltf or mesh.glb", frame.string());
  return found;
}

fs::path modelOf(const fs::path& frame) {
  for (const fs::path& model : {frame / "sparse", frame / "sparse" / "0"})
    if (holdsColmapModel(model)) return model;
  fail(ErrorCode::io, "{}: has no COLMAP model (cameras.txt or cameras.bin), and neither has its subfolder 0",
       (frame / "sparse").string());
}

HtmFrameInput inputOf(const fs::path& frame) {
  HtmFrameInput input{frame.filename().string(), meshOf(frame), modelOf(frame), frame / "images", frame / "masks"};
  check(fs::is_directory(input.images), ErrorCode::io, "{}: is missing or not a folder", input.images.string());
  if (!fs::is_directory(input.masks)) input.masks.clear();
  return input;
}

std::string keyOf(const HtmFrameInput& frame, const HtmBuildOptions& options) {
  Hash hash;
  addProgram(hash);
  for (const fs::path& input : {frame.mesh, frame.model, frame.images, frame.masks})
    if (input.empty())
      hash.add(false);
    else
      addFolder(hash, fs::weakly_canonical(input));
  hash.add(htmOptionsToJson(options));
  for (const std::string& name : options.exclude) hash.add(name);
  return fmt::format("{:016x}", hash.value());
}

// A folder that is deleted unless it was moved.
struct Draft {
  explicit Draft(fs::path at) : folder(std::move(at)) { remove(); }
  Draft(const Draft&) = delete;
  Draft& operator=(const Draft&) = delete;
  ~Draft() { remove(); }
  void remove() const {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
  }
  fs::path folder;
};

}  // namespace

std::vector<HtmFrameInput> findHtmFrames(const fs::path& folder) {
  check(fs::is_directory(folder), ErrorCode::io, "{}: is missing or not a folder", folder.string());
  std::vector<fs::path> folders;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_directory() && !entry.path().filename().string().starts_with('.')) folders.push_back(entry.path());
  check(!folders.empty(), ErrorCode::invalidInput,
        "{}: has no frames; each frame is a folder with a mesh, sparse and images", folder.string());
  std::ranges::sort(folders);
  std::vector<HtmFrameInput> frames;
  for (const fs::path& frame : folders) frames.push_back(inputOf(frame));
  return frames;
}

std::optional<HtmFrameModel> cachedHtmFrame(const HtmFrameInput& frame, const HtmBuildOptions& options,
                                            const fs::path& sequence) {
  const fs::path file = sequence / frame.name / kBuildFile;
  if (!fs::is_regular_file(file)) return std::nullopt;
  const Json json = jsonOrDiscarded(readTextFile(file));
  if (!json.is_object() || json.value("key", Json()) != keyOf(frame, options) || !json.contains("report"))
    return std::nullopt;
  if (!validateHtmModelFiles(sequence / frame.name, 1).empty()) return std::nullopt;
  return HtmFrameModel{true, 0, json.at("report")};
}

HtmFrameModel buildHtmFrame(const HtmFrameInput& frame, const HtmBuildOptions& options, const fs::path& sequence,
                            const ProgressCallback& progress, const LogCallback& log) {
  const fs::path modelFolder = sequence / frame.name;
  check(!fs::exists(modelFolder) || assetKind(modelFolder) == AssetKind::htmModel, ErrorCode::invalidInput,
        "{}: exists and is not a harmonised model; remove it or choose another output folder", modelFolder.string());
  const Draft draft(sequence / fmt::format(".{}.part", frame.name));
  const std::string key = keyOf(frame, options);  // computed before the build, during which files may change
  HtmBuildOptions build = options;
  build.mesh = frame.mesh;
  build.model = frame.model;
  build.images = frame.images;
  build.masks = frame.masks;
  build.output = draft.folder;
  const Stopwatch watch;
  HtmFrameModel made;
  try {
    made.report = htmReportJson(buildHtm(build, progress, log).report);
  } catch (const Error& e) {
    if (e.code() == ErrorCode::cancelled) throw;
    fail(e.code(), "frame {}: {}", frame.name, e.what());
  }
  made.seconds = watch.seconds();
  writeFile(draft.folder / kBuildFile, jsonText({{"key", key}, {"report", made.report}}));
  fs::remove_all(modelFolder);
  fs::rename(draft.folder, modelFolder);
  return made;
}

}  // namespace ibr::app
