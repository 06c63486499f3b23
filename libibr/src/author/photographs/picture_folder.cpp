// SPDX-License-Identifier: Apache-2.0
#include "ibr/author/photographs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string_view>

#include "ibr/error.h"
#include "io/image_file.h"
#include "scene/scene_file.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

std::string lowered(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  return text;
}

template <std::size_t N>
bool isOneOf(std::string_view word, const std::array<std::string_view, N>& words) {
  return std::ranges::find(words, word) != words.end();
}

bool isReadable(std::string_view extension) {
  constexpr std::array<std::string_view, 5> kRead{".jpg", ".jpeg", ".png", ".tif", ".tiff"};
  return isOneOf(extension, kRead);
}

bool isRawExtension(std::string_view extension) {
  constexpr std::array<std::string_view, 14> kRaw{".dng", ".nef", ".nrw", ".cr2", ".cr3", ".crw", ".arw",
                                                  ".raf", ".rw2", ".orf", ".pef", ".srw", ".3fr", ".iiq"};
  return isOneOf(extension, kRaw);
}

bool isUnsupported(std::string_view extension) {
  constexpr std::array<std::string_view, 9> kForeign{".heic", ".heif", ".hif", ".avif", ".webp",
                                                     ".gif",  ".bmp",  ".jxl", ".jp2"};
  return isOneOf(extension, kForeign);
}

// Folders in which network disks, other systems and galleries keep previews.
bool isPreviewFolder(const std::string& folder) {
  constexpr std::array<std::string_view, 5> kPreviews{"@eadir", "__macosx", "thumbnails", "thumbs", "previews"};
  return isOneOf(lowered(folder), kPreviews);
}

std::string stemOf(const std::string& name) {
  return fs::path(name).replace_extension().generic_string();
}

// True for scenes, and for folders in which one is being built.
bool isScene(const fs::path& folder) {
  std::error_code ignored;
  return std::ranges::any_of(std::array{kSceneFileName, ".build", ".poses"},
                             [&](const char* name) { return fs::exists(folder / name, ignored); });
}

constexpr const char* kHeicFault = "HEIC files are not read: convert them, for example with heif-convert -q 95";

// Returns the reason why a file named as a photograph cannot be one; "" if it may be. The extension is in lower case.
std::string faultOf(const fs::path& file, const std::string& extension) {
  std::error_code ignored;
  if (fs::file_size(file, ignored) == 0) return "is empty: copy it from the camera again";
  if (isRawExtension(extension)) return "raw files are not read: develop them as JPEG or 16-bit TIFF";
  std::string foreign;
  try {
    foreign = unsupportedImageFormat(file);
  } catch (const Error& error) {
    return "cannot be read";
  }
  if (foreign.ends_with(" raw")) return "raw files are not read: develop them as JPEG or 16-bit TIFF";
  if (foreign == "HEIC") return kHeicFault;
  if (foreign == "video") return "is a video: extract photographs from it, for example with ffmpeg";
  if (!foreign.empty()) return foreign + " files are not read: convert them to JPEG";
  if (isOneOf(extension, std::array<std::string_view, 3>{".heic", ".heif", ".hif"})) return kHeicFault;
  if (isUnsupported(extension)) return extension.substr(1) + " files are not read: convert them to JPEG";
  return isImageFile(file) ? "" : "is not a JPEG, PNG or TIFF file, despite its extension";
}

}  // namespace

PhotographFolder scanPhotographFolder(const fs::path& folder) {
  PhotographFolder found;
  std::set<std::string> stems;
  fs::recursive_directory_iterator at(folder, fs::directory_options::skip_permission_denied);
  for (; at != fs::recursive_directory_iterator(); ++at) {
    const std::string file = at->path().filename().string();
    std::error_code ignored;  // dangling links
    if (at->is_directory(ignored)) {
      if (file.starts_with('.') || isPreviewFolder(file) || isScene(at->path())) at.disable_recursion_pending();
      continue;
    }
    const std::string extension = lowered(at->path().extension().string());
    if (file.starts_with('.') || !at->is_regular_file(ignored)) continue;
    if (!isReadable(extension) && !isRawExtension(extension) && !isUnsupported(extension)) continue;
    const std::string name = at->path().lexically_relative(folder).generic_string();
    std::string fault = faultOf(at->path(), extension);
    if (fault.empty() && isReadable(extension)) {
      found.pictures.push_back(name);
      stems.insert(stemOf(name));
    } else {
      found.unreadable.push_back({name, std::move(fault)});
    }
  }
  std::erase_if(found.unreadable, [&](const auto& unreadable) { return stems.contains(stemOf(unreadable.name)); });
  std::ranges::sort(found.pictures);
  std::ranges::sort(found.unreadable, {}, &PhotographFolder::UnreadableFile::name);
  return found;
}

Image8 readPicture(const fs::path& file) {
  return readImage(file);
}

std::string unreadableText(const std::vector<PhotographFolder::UnreadableFile>& unreadable) {
  constexpr std::size_t kMaxListed = 3;
  std::map<std::string, std::vector<std::string>> byReason;
  for (const auto& [name, reason] : unreadable) byReason[reason].push_back(name);
  std::string text;
  for (const auto& [reason, names] : byReason) {
    const std::size_t named = std::min(names.size(), kMaxListed);
    text += fmt::format("{}{}", text.empty() ? "" : "; ", fmt::join(names.begin(), names.begin() + long(named), ", "));
    if (names.size() > named) text += fmt::format(" and {} more", names.size() - named);
    text += fmt::format(": {}", reason);
  }
  return text;
}

}  // namespace ibr
