// SPDX-License-Identifier: Apache-2.0
// What lies in a folder of photographs: those that can be read, and what else looks like one.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace ibr {

struct PictureFolder {
  struct Unread {
    std::string name;
    std::string reason;  // for people: what it is, and what to do
  };
  std::vector<std::string> pictures;  // begin as JPEG, PNG or TIFF files do, and are called so
  std::vector<Unread> unread;         // photographs by name or content that are not read here, or damaged
};

/// Names are relative to the folder (with '/'), sorted. Folders below it are looked at, links to folders are not. Left
/// out without a word: hidden files and folders (._IMG_1.jpg), scenes, previews that other programs keep in folders of
/// their own, and files beside a picture of the same name but for the extension (IMG_1.CR2 beside IMG_1.JPG). Throws
/// std::filesystem::filesystem_error.
PictureFolder lookInto(const std::filesystem::path& folder);

/// One line that names the files, at most three of a reason; "" where there are none.
std::string unreadText(const std::vector<PictureFolder::Unread>& unread);

}  // namespace ibr
