// SPDX-License-Identifier: Apache-2.0
#include "batch/files/truth.h"

#include <algorithm>

#include "base/check.h"
#include "base/file.h"
#include "batch/files/poses.h"
#include "ibr/author/poses.h"
#include "io/image_file.h"

namespace fs = std::filesystem;

namespace ibr::app {

Truth::Truth(const fs::path& folder, const std::vector<std::string>& names, const LogCallback& log) {
  check(fs::is_directory(folder), ErrorCode::io, "{}: is not a folder", folder.string());
  fs::path model;
  for (const fs::path& candidate : {folder / "sparse", folder / "sparse" / "0", folder})
    if (model.empty() && holdsColmapModel(candidate)) model = candidate;
  check(!model.empty(), ErrorCode::io,
        "{}: no COLMAP model (cameras.txt or cameras.bin) in this folder, in sparse or in sparse/0", folder.string());
  images_ = fs::is_directory(folder / "images") ? folder / "images" : folder;

  std::vector<View> all;
  for (PosedImage& image : readColmapModel(model, log).images) {
    if (image.lens) lenses_.emplace(image.name, *image.lens);
    all.push_back({std::move(image.name), image.camera});
  }
  for (const std::string& name : names)
    check(std::ranges::find(all, name, &View::name) != all.end(), ErrorCode::invalidInput,
          "{}: has no view {} (--views)", model.string(), name);
  for (View& view : all) {
    if (!names.empty() && std::ranges::find(names, view.name) == names.end()) continue;
    if (names.empty() && !fs::exists(images_ / view.name)) {
      if (log)
        log(LogLevel::warning, fmt::format("{}: image is missing, view skipped", (images_ / view.name).string()));
      continue;
    }
    views_.push_back(std::move(view));
  }
  check(!views_.empty(), ErrorCode::invalidInput, "{}: no view has an image in {}", model.string(), images_.string());
}

Image8 Truth::picture(const View& view) const {
  const fs::path file = pathBelow(images_, view.name);
  Image8 image = readImage(file);
  const Intrinsics& k = view.camera.intrinsics;
  const auto lens = lenses_.find(view.name);
  const bool distorted = lens != lenses_.end();
  const int width = distorted ? lens->second.width() : k.width, height = distorted ? lens->second.height() : k.height;
  check(image.width == width && image.height == height, ErrorCode::invalidInput,
        "{}: is {}×{} px, but its camera is {}×{} px", file.string(), image.width, image.height, width, height);
  return distorted ? undistort(image, lens->second, k) : image;
}

ImageF truthDepth(const fs::path& folder, const std::string& view, double unit) {
  const Image<std::uint16_t> steps = readGrey16(pictureFile(folder, view));
  ImageF depth(steps.width, steps.height, 1);
  std::ranges::transform(steps.values, depth.values.begin(),
                         [unit](std::uint16_t s) { return float(unit * double(s)); });
  return depth;
}

}  // namespace ibr::app
