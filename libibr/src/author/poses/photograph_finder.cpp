// SPDX-License-Identifier: Apache-2.0
#include "author/poses/photograph_finder.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "base/check.h"
#include "ibr/author/photographs.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

constexpr std::array kExtensions{".jpg", ".JPG", ".jpeg", ".JPEG", ".png", ".PNG", ".tif", ".TIF", ".tiff", ".TIFF"};

fs::path withSlashes(std::string path) {
  std::ranges::replace(path, '\\', '/');
  return fs::path(path).lexically_normal();
}

bool isFile(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

std::string onlyOne(const std::map<std::string, std::vector<std::string>>& names, const std::string& key) {
  const auto found = names.find(key);
  return found != names.end() && found->second.size() == 1 ? found->second[0] : std::string();
}

}  // namespace

std::string plainName(const std::string& path) {
  const fs::path normal = withSlashes(path);
  const bool isDrive = !normal.empty() && normal.begin()->string().ends_with(':');
  const bool leadsOut = normal.is_absolute() || isDrive || (!normal.empty() && *normal.begin() == "..");
  return (leadsOut ? normal.filename() : normal).generic_string();
}

void PhotographFinder::scan() {
  if (std::exchange(scanned_, true)) return;
  for (const std::string& name : scanPhotographFolder(folder_).pictures) {
    byFile_[fs::path(name).filename().string()].push_back(name);
    byStem_[fs::path(name).stem().string()].push_back(name);
  }
}

std::optional<std::string> PhotographFinder::findExact(const std::string& path) const {
  const fs::path plain = withSlashes(path);
  const bool isInside = !folder_.empty() && plain.is_relative() && !plain.empty() && *plain.begin() != "..";
  return isInside && isFile(folder_ / plain) ? std::optional(plain.generic_string()) : std::nullopt;
}

std::optional<std::string> PhotographFinder::find(const std::string& path) {
  std::error_code ignored;
  if (folder_.empty() || !fs::is_directory(folder_, ignored)) return std::nullopt;
  const fs::path plain = withSlashes(path).relative_path();
  auto first = plain.begin();
  while (first != plain.end() && *first == "..") ++first;
  for (; first != plain.end(); ++first) {
    fs::path end;
    for (auto part = first; part != plain.end(); ++part) end /= *part;
    if (!end.has_filename()) break;
    if (isFile(folder_ / end)) return end.generic_string();
    for (const char* extension : kExtensions)
      if (const fs::path named = end.string() + extension; isFile(folder_ / named)) return named.generic_string();
  }
  scan();
  for (const std::string& name : {onlyOne(byFile_, plain.filename().string()),
                                  onlyOne(byStem_, plain.filename().string()), onlyOne(byStem_, plain.stem().string())})
    if (!name.empty()) return name;
  return std::nullopt;
}

void nameAndSort(PosedModel& model, const fs::path& file, PhotographFinder& photographs, bool namesAreRelative) {
  std::map<std::string, std::string> given;  // the file's name of each photograph
  const auto take = [&](PosedImage& image, const std::string& name) {
    const auto [other, isNew] = given.emplace(name, image.name);
    check(isNew, ErrorCode::invalidInput, "{}: images \"{}\" and \"{}\" both match the photograph {}", file.string(),
          other->second, image.name, name);
    image.name = name;
  };
  std::vector<PosedImage*> others;
  for (PosedImage& image : model.images) {
    const auto exact = photographs.findExact(image.name);
    exact ? take(image, *exact) : others.push_back(&image);
  }
  const std::map<std::string, std::string> exact = given;
  for (PosedImage* image : others) {
    const auto found = photographs.find(image->name);
    if (found && !exact.contains(*found))
      take(*image, *found);
    else
      take(*image, namesAreRelative ? image->name : plainName(image->name));
  }
  std::vector<std::uint32_t> order(model.images.size()), now(model.images.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::sort(order, {}, [&](std::uint32_t i) -> const std::string& { return model.images[i].name; });
  std::vector<PosedImage> sorted;
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    now[order[i]] = i;
    sorted.push_back(std::move(model.images[order[i]]));
  }
  model.images = std::move(sorted);
  for (Track& track : model.tracks) {
    for (TrackObservation& observation : track.observations) observation.image = now[observation.image];
    std::ranges::sort(track.observations, {}, &TrackObservation::image);
  }
  std::erase_if(model.tracks, [](const Track& track) { return track.observations.empty(); });
}

}  // namespace ibr
