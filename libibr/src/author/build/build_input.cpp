// SPDX-License-Identifier: Apache-2.0
#include "author/build/build_input.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "author/geometry/posed_model.h"
#include "author/graph/cells.h"
#include "author/photographs/masks.h"
#include "author/poses/phone_poses.h"
#include "base/check.h"
#include "base/file.h"
#include "ibr/author/build.h"
#include "ibr/author/photographs.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

// File names need not be valid UTF-8, but a scene can store only UTF-8: replaces invalid bytes.
std::string utf8Of(const std::string& name) {
  using Json = nlohmann::json;
  return Json::parse(Json(name).dump(-1, ' ', false, Json::error_handler_t::replace)).get<std::string>();
}

// Files of the photographs' folder that the model lacks. Skips images of the output scene below that folder.
std::vector<UnusedPhotograph> photographsNotInModel(const PosedModel& model, const BuildOptions& options) {
  std::set<std::string> known;
  std::set<fs::path> knownFiles;  // links may give one file several names
  std::error_code ignored;
  for (const PosedImage& image : model.images) {
    known.insert(image.name);
    knownFiles.insert(fs::weakly_canonical(options.photographs / image.name, ignored));
  }
  known.insert(options.exclude.begin(), options.exclude.end());
  const fs::path scene = fs::weakly_canonical(options.output) / "images";
  const fs::path photographs = fs::weakly_canonical(options.photographs);
  std::vector<UnusedPhotograph> unknown;
  const auto add = [&](const std::string& name, const std::string& reason) {
    const fs::path inScene = (photographs / name).lexically_relative(scene);
    const bool isKnown =
        known.contains(name) || knownFiles.contains(fs::weakly_canonical(options.photographs / name, ignored));
    if (!isKnown && (inScene.empty() || *inScene.begin() == "..")) unknown.push_back({utf8Of(name), reason});
  };
  const PhotographFolder folder = scanPhotographFolder(options.photographs);
  for (const std::string& name : folder.pictures) add(name, std::string(kNotRegistered));
  for (const auto& [name, reason] : folder.unreadable) add(name, reason);
  std::ranges::sort(unknown, {}, &UnusedPhotograph::name);
  return unknown;
}

// Lists images of the model that the folder lacks, e.g. "IMG_1.jpg (the folder has IMG_1.JPG), …".
std::string missingText(const std::vector<std::string>& missing, const fs::path& folder) {
  constexpr std::size_t kMaxListed = 5;
  const auto lowered = [](std::string text) {
    for (char& c : text)
      if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    return text;
  };
  std::map<std::string, std::string> there;
  for (const std::string& name : scanPhotographFolder(folder).pictures) there.emplace(lowered(name), name);
  std::vector<std::string> named;
  for (std::size_t i = 0; i < std::min(missing.size(), kMaxListed); ++i) {
    const auto found = there.find(lowered(missing[i]));
    named.push_back(missing[i] + (found == there.end() ? "" : " (the folder has " + found->second + ")"));
  }
  return fmt::format("{}{}", fmt::join(named, ", "),
                     missing.size() > kMaxListed ? fmt::format(" and {} more", missing.size() - kMaxListed) : "");
}

// Reports all faults in one error.
void findPhotographs(BuildInput& input, const BuildOptions& options) {
  std::vector<std::string> missing, faults;
  for (const PosedImage& image : input.model.images) {
    std::error_code ignored;
    if (!fs::exists(pathBelow(options.photographs, image.name), ignored)) {
      missing.push_back(image.name);
      continue;
    }
    try {
      input.photographs.push_back(findPhotograph(options.photographs, image, options.maxSize, options.orientation));
    } catch (const Error& error) {
      if (!isFileError(error)) throw;
      faults.push_back(error.what());
    }
  }
  check(missing.empty(), ErrorCode::io,
        "{}: {} of the model's {} photographs are missing: {}. The model's names must be relative to this folder; "
        "--exclude leaves photographs out",
        options.photographs.string(), missing.size(), input.model.images.size(),
        missing.empty() ? "" : missingText(missing, options.photographs));
  checkReadable(std::move(faults));
}

// Decides the orientation of photographs whose shape leaves the choice open: as the other photographs, if they agree.
void resolveOrientations(const PosedModel& model, const BuildOptions& options, std::vector<Photograph>& photographs,
                         const LogCallback& log) {
  if (options.orientation != Orientation::automatic) return;
  std::vector<std::size_t> unsure;
  bool turned = false;
  for (std::size_t i = 0; i < photographs.size(); ++i) {
    turned = turned || photographs[i].applyOrientation;
    if (photographs[i].orientationAmbiguous) unsure.push_back(i);
  }
  if (unsure.empty()) return;
  if (turned)
    for (const std::size_t i : unsure)
      photographs[i] = findPhotograph(options.photographs, model.images[i], options.maxSize, Orientation::exif);
  if (log)
    log(LogLevel::warning,
        fmt::format(
            "{} of {} photographs have an EXIF rotation, and their cameras fit both orientations ({}{}): they are used "
            "{}. If frames come out rotated, set --orientation {}",
            unsure.size(), photographs.size(), photographs[unsure[0]].name, unsure.size() > 1 ? ", …" : "",
            turned ? "upright, like the other rotated photographs" : "as stored, like in COLMAP",
            turned ? "stored" : "exif"));
}

// Stored names may collide: "a.tif" is stored as "a.tif.png".
void checkStoredNames(const std::vector<Photograph>& photographs) {
  std::map<fs::path, std::string> stored;
  for (const Photograph& photo : photographs) {
    const auto [other, fresh] = stored.emplace(photo.imageFile, photo.name);
    check(fresh, ErrorCode::invalidInput, "{} and {}: the scene would store both as {}; rename one", other->second,
          photo.name, photo.imageFile.string());
  }
}

// Warns about masks without a photograph, which may be misnamed. Masks of excluded photographs are expected.
void findMasks(std::vector<Photograph>& photographs, const BuildOptions& options, const LogCallback& log) {
  if (options.masks.empty()) return;
  std::set<fs::path> expected;
  const auto expect = [&](const std::string& name) {
    for (const fs::path& file : {fs::path(name + ".png"), fs::path(name).replace_extension(".png")})
      expected.insert(file.lexically_normal());
  };
  for (const std::string& name : scanPhotographFolder(options.photographs).pictures) expect(name);
  for (Photograph& photo : photographs) {
    expect(photo.name);
    const std::optional<fs::path> mask = findMaskFile(options.masks, photo.name);
    if (!mask) continue;
    checkMaskSize(photo, *mask);
    photo.mask = *mask;
  }
  if (!log) return;
  for (const std::string& name : scanPhotographFolder(options.masks).pictures)
    if (!expected.contains(fs::path(name).lexically_normal()))
      log(LogLevel::warning,
          fmt::format("{}: no photograph has the name of this mask", (options.masks / name).string()));
  const auto without = std::ranges::count_if(photographs, [](const Photograph& photo) { return photo.mask.empty(); });
  if (without > 0)
    log(LogLevel::warning, fmt::format("{}: {} of the {} photographs have no mask, for example {}: they are used whole",
                                       options.masks.string(), without, photographs.size(),
                                       std::ranges::find_if(photographs, &fs::path::empty, &Photograph::mask)->name));
}

// Names to exclude. A name that only the folder has, not the model, is skipped; a name that neither has is an error.
std::vector<std::string> excludedNames(const PosedModel& model, const BuildOptions& options) {
  std::vector<std::string> names = options.exclude;
  std::erase_if(names, [&](const std::string& name) {
    return std::ranges::find(model.images, name, &PosedImage::name) == model.images.end() &&
           fs::is_regular_file(options.photographs / name);
  });
  return names;
}

// Leaves out images of the model that have no photograph.
void skipMissing(PosedModel& model, const BuildOptions& options, const LogCallback& log) {
  std::vector<std::string> missing;
  for (const PosedImage& image : model.images) {
    std::error_code ignored;
    if (!fs::exists(pathBelow(options.photographs, image.name), ignored)) missing.push_back(image.name);
  }
  if (missing.size() == model.images.size()) return;  // an error below, which names some
  if (log && !missing.empty())
    log(LogLevel::info, fmt::format("{} of the model's {} images have no photograph and are left out", missing.size(),
                                    model.images.size()));
  removeImages(model, missing);
}

bool decideRefinement(const BuildInput& input, const BuildOptions& options) {
  if (options.refinePoses != RefinePoses::automatic) return options.refinePoses == RefinePoses::on;
  if (!input.model.tracks.empty()) return false;
  const auto ofPhones = std::ranges::count_if(
      input.photographs, [](const Photograph& photo) { return isPhoneMaker(photo.capture.maker); });
  return 2 * std::size_t(ofPhones) > input.photographs.size() || isPhoneAppFile(options.model);
}

}  // namespace

void checkOptions(const BuildOptions& options) {
  check(options.threads >= 0, ErrorCode::invalidInput, "threads is {}, must be 0 or more", options.threads);
  check(options.memory >= 0 && std::isfinite(options.memory), ErrorCode::invalidInput,
        "memory is {} bytes, must be finite and 0 or more", options.memory);
  check(options.maxSize >= 0, ErrorCode::invalidInput, "maxSize is {} px, must be 0 or more", options.maxSize);
  const int spacing = options.backdropSpacing;
  check(spacing >= 2 && spacing <= 32 && std::has_single_bit(unsigned(spacing)), ErrorCode::invalidInput,
        "backdropSpacing is {} px, must be 2, 4, 8, 16 or 32", spacing);
  check(!options.output.empty(), ErrorCode::invalidInput, "the output folder of the scene is not set");
  checkPlanOptions(options);
  check(options.masks.empty() || fs::is_directory(options.masks), ErrorCode::io, "{}: is not a folder of masks",
        options.masks.string());
  check(fs::is_directory(options.photographs), ErrorCode::io, "{}: is not a folder", options.photographs.string());
}

void checkOutputFolder(const BuildOptions& options) {
  std::error_code missing;
  check(!fs::equivalent(options.photographs, options.output, missing), ErrorCode::invalidInput,
        "{}: is the folder of the photographs; choose another output folder", options.output.string());
}

BuildInput readInput(const BuildOptions& options, const LogCallback& log) {
  checkOptions(options);
  BuildInput input;
  input.model = readPoses(options, log);
  input.unknown = photographsNotInModel(input.model, options);
  removeImages(input.model, excludedNames(input.model, options));
  check(!input.model.images.empty(), ErrorCode::invalidInput, "{}: no image is left", options.model.string());
  if (options.skipMissing) skipMissing(input.model, options, log);
  findPhotographs(input, options);
  resolveOrientations(input.model, options, input.photographs, log);
  for (Photograph& photo : input.photographs) photo.stripped = options.stripMetadata;
  checkStoredNames(input.photographs);
  findMasks(input.photographs, options, log);
  input.tracksOf = tracksOfImages(input.model);
  input.refine = reprojectionError(input.model) > kExactPx;
  input.refinesPoses = decideRefinement(input, options);
  if (log && input.refinesPoses && options.refinePoses == RefinePoses::automatic)
    log(LogLevel::info, "the poses are a phone's, and are refined; --refine-poses off keeps them");
  return input;
}

bool isPanorama(const Photograph& photograph) {
  return photograph.camera.intrinsics.model == CameraModel::equirectangular;
}

fs::path buildCacheFolder(const BuildOptions& options) {
  return options.cacheFolder.empty() ? options.output / ".build" : options.cacheFolder;
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
