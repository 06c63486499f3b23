// SPDX-License-Identifier: Apache-2.0
#include "author/build_input.h"

#include <bit>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "author/cells.h"
#include "author/posed_model.h"
#include "author/read_poses.h"
#include "base/check.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

// What can stand in a scene: names of files need not be UTF-8.
std::string utf8Of(const std::string& name) {
  using Json = nlohmann::json;
  return Json::parse(Json(name).dump(-1, ' ', false, Json::error_handler_t::replace)).get<std::string>();
}

// Pictures that a scene keeps below the photographs are its own.
std::vector<UnusedPhotograph> unknownTo(const PosedModel& model, const BuildOptions& options) {
  std::set<std::string> known;
  for (const PosedImage& image : model.images) known.insert(image.name);
  const fs::path scene = fs::weakly_canonical(options.output) / "images";
  const fs::path photographs = fs::weakly_canonical(options.photographs);
  std::vector<UnusedPhotograph> unknown;
  for (const std::string& name : listPictures(options.photographs)) {
    const fs::path inScene = (photographs / name).lexically_relative(scene);
    if (!known.contains(name) && (inScene.empty() || *inScene.begin() == ".."))
      unknown.push_back({utf8Of(name), "not registered: the model has no pose for it"});
  }
  return unknown;
}

// "a.tif" is stored as "a.tif.png".
void checkStoredNames(const std::vector<Photograph>& photographs) {
  std::map<fs::path, std::string> stored;
  for (const Photograph& photo : photographs) {
    const auto [other, fresh] = stored.emplace(photo.imageFile, photo.name);
    check(fresh, ErrorCode::invalidInput, "{} and {}: a scene would store both as {}", other->second, photo.name,
          photo.imageFile.string());
  }
}

}  // namespace

void checkOptions(const BuildOptions& options) {
  check(options.threads >= 0, ErrorCode::invalidInput, "{} threads are not 0 or more", options.threads);
  check(options.maxSize >= 0, ErrorCode::invalidInput, "largest size {} px is not 0 or more", options.maxSize);
  const int spacing = options.backdropSpacing;
  check(spacing >= 2 && spacing <= 32 && std::has_single_bit(unsigned(spacing)), ErrorCode::invalidInput,
        "spacing {} px of backdrops' vertices is not 2, 4, 8, 16 or 32", spacing);
  check(!options.output.empty(), ErrorCode::invalidInput, "no folder is named for the scene");
  checkPlanOptions(options);
  check(fs::is_directory(options.photographs), ErrorCode::io, "{}: is not a folder", options.photographs.string());
}

BuildInput readInput(const BuildOptions& options, const LogCallback& log) {
  checkOptions(options);
  BuildInput input;
  input.model = readPoses(options, log);
  input.unknown = unknownTo(input.model, options);
  removeImages(input.model, options.exclude);
  check(!input.model.images.empty(), ErrorCode::invalidInput, "{}: no image is left",
        posesFile(options).string());
  for (const PosedImage& image : input.model.images)
    input.photographs.push_back(findPhotograph(options.photographs, image, options.maxSize));
  checkStoredNames(input.photographs);
  input.tracksOf = tracksOfImages(input.model);
  input.refine = reprojectionError(input.model) > kExactPx;
  return input;
}

bool isPanorama(const Photograph& photograph) {
  return photograph.camera.intrinsics.model == CameraModel::equirectangular;
}

fs::path keptFolder(const BuildOptions& options) {
  return options.finishedCells.empty() ? options.output / ".build" : options.finishedCells;
}

void addPhotograph(Hash& hash, const BuildInput& input, std::uint32_t i) {
  const Photograph& photograph = input.photographs[i];
  hash.add(input.hashes[i]);
  const Intrinsics& k = photograph.camera.intrinsics;
  const Pose& pose = photograph.camera.pose;
  hash.add(photograph.applyOrientation);
  for (const double v : {double(k.width), double(k.height), k.fx, k.fy, k.cx, k.cy, pose.position.x, pose.position.y,
                         pose.position.z, pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z})
    hash.add(v);
}

void addPoints(Hash& hash, const std::vector<glm::dvec3>& points) {
  for (const glm::dvec3& p : points)
    for (int c = 0; c < 3; ++c) hash.add(p[c]);
}

}  // namespace ibr
