// SPDX-License-Identifier: Apache-2.0
#include "batch/files/poses.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>

#include "base/check.h"
#include "base/file.h"
#include "ibr/author/poses.h"
#include "io/image_file.h"
#include "shared/draw/picture_record.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

Intrinsics withSize(const Intrinsics& k, PictureSize size) {
  const double scale = double(size.height) / k.height;
  return {k.model,      size.width,   size.height,
          k.fx * scale, k.fy * scale, 0.5 * size.width + (k.cx - 0.5 * k.width) * scale,
          k.cy * scale};
}

// Removes the extension of an image file; "frame.0001" has none.
std::string stem(const std::string& name) {
  constexpr std::array kExtensions{".jpg", ".jpeg", ".png", ".tif", ".tiff", ".bmp", ".webp", ".heic", ".exr", ".dng"};
  std::string extension = fs::path(name).extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  const bool known = std::ranges::find(kExtensions, extension) != kExtensions.end();
  return known ? name.substr(0, name.size() - extension.size()) : name;
}

// "hall_l.jpg" with 'l' → "hall"; nullopt if the name is not of this eye.
std::optional<std::string> withoutEye(const std::string& name, char eye) {
  const std::string whole = stem(name), ending{'_', eye};
  if (!whole.ends_with(ending)) return std::nullopt;
  return whole.substr(0, whole.size() - ending.size());
}

View viewIn(const fs::path& picture, PictureSize size) {
  const auto record = readRecord(picture);
  check(record.has_value(), ErrorCode::invalidInput, "{}: no view is stored in this image", picture.string());
  View view{picture.filename().string(), record->camera, record->time.value_or(0)};
  if (size.width > 0) view.camera.intrinsics = withSize(view.camera.intrinsics, size);
  return view;
}

// Returns "hall_r.png" for "hall_l.png", and vice versa; nullopt if the image is of no eye. Throws if it is missing.
std::optional<fs::path> otherEye(const fs::path& picture) {
  const std::string name = picture.filename().string();
  for (const auto& [eye, other] : {std::pair('l', 'r'), {'r', 'l'}})
    if (const auto both = withoutEye(name, eye)) {
      const fs::path beside = picture.parent_path() / (*both + '_' + other + picture.extension().string());
      std::error_code ignored;
      check(fs::exists(beside, ignored), ErrorCode::invalidInput, "{}: the image of the {} eye is missing: {}",
            picture.string(), other == 'l' ? "left" : "right", beside.string());
      return beside;
    }
  return std::nullopt;
}

}  // namespace

bool holdsColmapModel(const fs::path& folder) {
  std::error_code ignored;
  return fs::exists(folder / "cameras.txt", ignored) || fs::exists(folder / "cameras.bin", ignored);
}

bool isWalk(const fs::path& poses) {
  std::error_code ignored;
  return !fs::is_directory(poses, ignored) && (isImageFile(poses) || !poseFormatOf(poses));
}

std::vector<View> readViews(const fs::path& poses, PictureSize size, const LogCallback& log, bool stereo) {
  std::error_code ignored;
  const bool folder = fs::is_directory(poses, ignored);
  if (!folder && isImageFile(poses)) {
    std::vector<View> views{viewIn(poses, size)};
    if (const auto other = stereo ? otherEye(poses) : std::nullopt) views.push_back(viewIn(*other, size));
    return views;
  }
  if (!folder && !poseFormatOf(poses)) {
    CameraPath path = readCameraPath(poses);
    if (size.width > 0) {
      path.width = size.width;
      path.height = size.height;
    }
    return frames(path);
  }
  std::vector<View> views;
  for (PosedImage& image : readPoseFile(poses, {}, log).images) {
    if (size.width > 0) image.camera.intrinsics = withSize(image.camera.intrinsics, size);
    views.push_back({std::move(image.name), image.camera});
  }
  return views;
}

void setFov(std::vector<View>& views, double fovY) {
  for (View& view : views) {
    Intrinsics& k = view.camera.intrinsics;
    const double focal = 0.5 * k.height / std::tan(0.5 * fovY);
    k.fx *= focal / k.fy;
    k.fy = focal;
  }
}

std::vector<Frame> framesOf(const std::vector<View>& views, bool stereo, double ipd) {
  std::vector<Frame> frames;
  if (!stereo) {
    for (const View& view : views) frames.push_back({view});
    return frames;
  }
  std::map<std::string, const View*> rightEyes;
  for (const View& view : views)
    if (const auto name = withoutEye(view.name, 'r')) rightEyes.emplace(*name, &view);
  for (const View& view : views) {
    if (withoutEye(view.name, 'r')) continue;
    if (const auto name = withoutEye(view.name, 'l')) {
      const auto right = rightEyes.find(*name);
      check(right != rightEyes.end(), ErrorCode::invalidInput, "{}: the view of the right eye is missing: {}_r",
            view.name, *name);
      frames.push_back({view, *right->second});
      rightEyes.erase(right);
      continue;
    }
    check(ipd > 0, ErrorCode::invalidInput, "{}: --stereo needs --ipd, the distance between the eyes", view.name);
    Frame pair{view, view};
    const glm::dvec3 aside = view.camera.pose.rotation * glm::dvec3(0.5 * ipd, 0, 0);
    pair[0].camera.pose.position -= aside;
    pair[1].camera.pose.position += aside;
    pair[0].name = stem(view.name) + "_l";
    pair[1].name = stem(view.name) + "_r";
    frames.push_back(std::move(pair));
  }
  for (const auto& [name, view] : rightEyes)
    fail(ErrorCode::invalidInput, "{}: the view of the left eye is missing: {}_l", view->name, name);
  return frames;
}

fs::path pictureFile(const fs::path& folder, const std::string& viewName) {
  return pathInside(folder, stem(viewName) + ".png");
}

void checkNamesDiffer(const std::vector<View>& views) {
  std::map<std::string, std::string> seen;
  for (const View& view : views) {
    const auto [other, fresh] = seen.emplace(stem(view.name), view.name);
    check(fresh, ErrorCode::invalidInput, "{} and {} would be written to the same file {}.png", other->second,
          view.name, stem(view.name));
  }
}

}  // namespace ibr::app
