// SPDX-License-Identifier: Apache-2.0
#include "ibr/author/photographs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string_view>
#include <utility>

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

// Kinds of files by extension, in lower case. Of photographs of one name, the first kind is used.
enum class Kind { picture, compressed, raw, foreign, video, other };

Kind kindOf(std::string_view extension) {
  constexpr std::array<std::string_view, 5> kPictures{".jpg", ".jpeg", ".png", ".tif", ".tiff"};
  constexpr std::array<std::string_view, 5> kCompressed{".heic", ".heif", ".hif", ".avif", ".webp"};
  constexpr std::array<std::string_view, 20> kRaw{".dng", ".nef", ".nrw", ".cr2", ".cr3", ".crw", ".arw",
                                                  ".srf", ".sr2", ".raf", ".rw2", ".orf", ".pef", ".srw",
                                                  ".3fr", ".iiq", ".x3f", ".mrw", ".kdc", ".dcr"};
  constexpr std::array<std::string_view, 5> kForeign{".gif", ".bmp", ".jxl", ".jp2", ".psd"};
  constexpr std::array<std::string_view, 12> kVideos{".mp4",  ".mov", ".m4v",  ".avi", ".mkv",  ".mts",
                                                     ".m2ts", ".3gp", ".webm", ".mpg", ".insv", ".lrv"};
  if (isOneOf(extension, kPictures)) return Kind::picture;
  if (isOneOf(extension, kCompressed)) return Kind::compressed;
  if (isOneOf(extension, kRaw)) return Kind::raw;
  if (isOneOf(extension, kForeign)) return Kind::foreign;
  return isOneOf(extension, kVideos) ? Kind::video : Kind::other;
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

// Returns the reason why a file named as a photograph cannot be one; "" if it may be.
std::string faultOf(const fs::path& file, Kind kind) {
  std::error_code ignored;
  if (fs::file_size(file, ignored) == 0) return "is empty: copy it from the camera again";
  std::string foreign;
  try {
    foreign = unsupportedImageFormat(file);
  } catch (const Error& error) {
    return "cannot be read";
  }
  if (foreign == "video") return "is a video, despite its extension";
  if (!foreign.empty()) return foreign + " files are not read: convert them to JPEG";
  if (kind == Kind::foreign)
    return lowered(file.extension().string()).substr(1) + " files are not read: convert them to JPEG";
  return isImageFile(file) ? "" : "is not a photograph, despite its extension";
}

// Walks through a folder and its subfolders, also behind links. Calls `visit` with each file that is not hidden.
class FolderWalk {
 public:
  FolderWalk(const fs::path& root, PhotographFolder& found)
      : root_(root), canonicalRoot_(fs::canonical(root)), found_(found) {}

  template <class F>
  void run(F&& visit) {
    constexpr auto kOptions =
        fs::directory_options::skip_permission_denied | fs::directory_options::follow_directory_symlink;
    fs::recursive_directory_iterator at(root_, kOptions);
    for (; at != fs::recursive_directory_iterator(); ++at) {
      const std::string name = at->path().filename().string();
      std::error_code ignored;  // dangling links
      if (at->is_directory(ignored)) {
        if (name.starts_with('.') || isPreviewFolder(name) || isScene(at->path()) || isKnown(*at))
          at.disable_recursion_pending();
      } else if (!name.starts_with('.')) {
        if (at->is_regular_file(ignored) && isKnown(*at))
          ++found_.doubles;
        else if (at->is_regular_file(ignored))
          visit(at->path());
        else
          ++found_.others;
      }
    }
  }

 private:
  // True for a link to what is inside the root, which is found there, or to what another link has led to. A link to a
  // folder above would lead round in circles.
  bool isKnown(const fs::directory_entry& entry) {
    std::error_code ignored;
    if (!entry.is_symlink(ignored)) return false;
    const fs::path target = fs::canonical(entry.path(), ignored);
    return contains(canonicalRoot_, target) || contains(target, canonicalRoot_) || !targets_.insert(target).second;
  }
  static bool contains(const fs::path& folder, const fs::path& file) {
    return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first == folder.end();
  }

  fs::path root_, canonicalRoot_;
  PhotographFolder& found_;
  std::set<fs::path> targets_;
};

// Leaves the best kind of the photographs of each name.
void removeDoubles(std::vector<std::pair<std::string, Kind>>& pictures, std::size_t& doubles) {
  std::map<std::string, Kind> best;
  for (const auto& [name, kind] : pictures) {
    const auto [at, fresh] = best.emplace(stemOf(name), kind);
    if (!fresh) at->second = std::min(at->second, kind);
  }
  doubles +=
      std::erase_if(pictures, [&](const auto& picture) { return best.at(stemOf(picture.first)) < picture.second; });
}

}  // namespace

PhotographFolder scanPhotographFolder(const fs::path& folder) {
  PhotographFolder found;
  std::vector<std::pair<std::string, Kind>> pictures;
  FolderWalk(folder, found).run([&](const fs::path& file) {
    const Kind kind = kindOf(lowered(file.extension().string()));
    const std::string name = file.lexically_relative(folder).generic_string();
    if (kind == Kind::other)
      ++found.others;
    else if (kind == Kind::video)
      found.videos.push_back(name);
    else if (std::string fault = faultOf(file, kind); fault.empty())
      pictures.emplace_back(name, kind);
    else
      found.unreadable.push_back({name, std::move(fault)});
  });
  removeDoubles(pictures, found.doubles);
  std::set<std::string> stems;
  for (const auto& [name, kind] : pictures) {
    found.pictures.push_back(name);
    stems.insert(stemOf(name));
  }
  // Cameras store such files beside a photograph, telephones a short video.
  found.doubles += std::erase_if(found.unreadable, [&](const auto& file) { return stems.contains(stemOf(file.name)); });
  found.others += std::erase_if(found.videos, [&](const std::string& name) { return stems.contains(stemOf(name)); });
  std::ranges::sort(found.pictures);
  std::ranges::sort(found.videos);
  std::ranges::sort(found.unreadable, {}, &PhotographFolder::UnreadableFile::name);
  return found;
}

std::string countText(const PhotographFolder& folder) {
  const auto count = [](std::size_t number, const char* one, const char* several) {
    return fmt::format("{} {}", number, number == 1 ? one : several);
  };
  std::vector<std::string> left;
  if (folder.doubles > 0)
    left.push_back(
        count(folder.doubles, "file beside a photograph of its name", "files beside photographs of their names"));
  if (!folder.unreadable.empty())
    left.push_back(count(folder.unreadable.size(), "unreadable file", "unreadable files"));
  if (!folder.videos.empty())
    left.push_back(
        count(folder.videos.size(), "video (name it to use its frames)", "videos (name them to use their frames)"));
  if (folder.others > 0) left.push_back(count(folder.others, "other file", "other files"));
  std::string text = count(folder.pictures.size(), "photograph", "photographs");
  if (!left.empty()) text += fmt::format("; left out: {}", fmt::join(left, ", "));
  return text;
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
