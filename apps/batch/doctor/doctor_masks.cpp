// SPDX-License-Identifier: Apache-2.0
// Checks masks against their photographs, before a build.
#include <algorithm>
#include <set>

#include "base/check.h"
#include "batch/doctor/examined_photograph.h"
#include "batch/doctor/findings.h"
#include "ibr/author/photographs.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

// Accepts the photograph's size as stored in its file or as rotated by its EXIF orientation.
bool fits(const ImageFileInfo& mask, const ImageFileInfo& photo) {
  return (mask.width == photo.width && mask.height == photo.height) ||
         (photo.orientation >= 5 && mask.width == photo.height && mask.height == photo.width);
}

void examineMask(const fs::path& file, const ExaminedPhotograph& photo, Findings& findings) {
  try {
    const ImageFileInfo mask = probeImage(file);
    if (!fits(mask, photo.info))
      findings.add({"masks", Severity::serious,
                    fmt::format("{} is {}×{} px, but {} is {}×{} px.", file.string(), mask.width, mask.height,
                                photo.name, photo.info.width, photo.info.height),
                    "Make the mask again in the photograph's size, or remove it."});
  } catch (const Error& e) {
    findings.add({"masks", Severity::serious, fmt::format("A mask cannot be read: {}.", e.what()),
                  "Make the mask again, or remove it."});
  }
}

}  // namespace

void examineMasks(const fs::path& folder, const std::vector<ExaminedPhotograph>& photographs, Findings& findings) {
  check(fs::is_directory(folder), ErrorCode::io, "{}: is not a folder of masks", folder.string());
  std::set<fs::path> used;
  std::size_t masked = 0;
  for (const ExaminedPhotograph& photo : photographs) {
    const auto file = findMaskFile(folder, photo.name);
    if (!file) continue;
    used.insert(file->lexically_normal());
    ++masked;
    if (photo.readError.empty()) examineMask(*file, photo, findings);
  }
  findings.fact(fmt::format("masks: {} of {} photographs have a mask", masked, photographs.size()));
  std::vector<std::string> unmatched;
  for (const std::string& name : scanPhotographFolder(folder).pictures)
    if (!used.contains((folder / name).lexically_normal())) unmatched.push_back(name);
  if (!unmatched.empty())
    findings.add({"masks", Severity::warning,
                  fmt::format("{} of the masks match no photograph: {}.", unmatched.size(), someOf(unmatched)),
                  "Name masks after their photographs: a/b.jpg.png or a/b.png for a/b.jpg."});
}

}  // namespace ibr::app
