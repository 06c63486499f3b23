// SPDX-License-Identifier: Apache-2.0
// Lists a folder's photographs: the readable ones, and other files that look like photographs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace ibr {

struct PictureFolder {
  struct Unread {
    std::string name;
    std::string reason;  // for people: the fault, and what to do
  };
  std::vector<std::string> pictures;  // content and extension of JPEG, PNG or TIFF files
  std::vector<Unread> unread;         // photographs by name or content in unsupported formats, or damaged
};

/// Names are relative to the folder (with '/'), sorted. Subfolders are searched, links to folders are not.
/// Skipped silently: hidden files and folders (._IMG_1.jpg), scenes, other programs' preview folders, and files
/// beside an image that differ only in the extension (IMG_1.CR2 beside IMG_1.JPG). Throws
/// std::filesystem::filesystem_error.
PictureFolder lookInto(const std::filesystem::path& folder);

/// Returns one line that names the files, at most three per reason; "" if there are none.
std::string unreadText(const std::vector<PictureFolder::Unread>& unread);

}  // namespace ibr
