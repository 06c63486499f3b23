// SPDX-License-Identifier: Apache-2.0
#include "batch/poses.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>

#include "base/check.h"
#include "base/file.h"
#include "ibr/author.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

Intrinsics withSize(const Intrinsics& k, PictureSize size) {
  const double scale = double(size.height) / k.height;
  return {k.model,      size.width,   size.height,
          k.fx * scale, k.fy * scale, 0.5 * size.width + (k.cx - 0.5 * k.width) * scale,
          k.cy * scale};
}

// Without the extension of an image file. "frame.0001" has none.
std::string stem(const std::string& name) {
  constexpr std::array kExtensions{".jpg", ".jpeg", ".png", ".tif", ".tiff", ".bmp", ".webp", ".heic", ".exr", ".dng"};
  std::string extension = fs::path(name).extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  const bool known = std::ranges::find(kExtensions, extension) != kExtensions.end();
  return known ? name.substr(0, name.size() - extension.size()) : name;
}

}  // namespace

bool holdsColmapModel(const fs::path& folder) {
  std::error_code ignored;
  return fs::exists(folder / "cameras.txt", ignored) || fs::exists(folder / "cameras.bin", ignored);
}

std::vector<View> readViews(const fs::path& poses, PictureSize size, const LogCallback& log) {
  std::error_code ignored;
  if (!fs::is_directory(poses, ignored)) {
    CameraPath path = readCameraPath(poses);
    if (size.width > 0) {
      path.width = size.width;
      path.height = size.height;
    }
    return frames(path);
  }
  std::vector<View> views;
  for (PosedImage& image : readColmapModel(poses, log).images) {
    if (size.width > 0) image.camera.intrinsics = withSize(image.camera.intrinsics, size);
    views.push_back({std::move(image.name), image.camera});
  }
  return views;
}

fs::path pictureFile(const fs::path& folder, const std::string& viewName) {
  return pathInside(folder, stem(viewName) + ".png");
}

void checkNamesDiffer(const std::vector<View>& views) {
  std::map<std::string, std::string> seen;
  for (const View& view : views) {
    const auto [other, fresh] = seen.emplace(stem(view.name), view.name);
    check(fresh, ErrorCode::invalidInput, "{} and {} would be written to the same picture {}.png", other->second,
          view.name, stem(view.name));
  }
}

}  // namespace ibr::app
