// SPDX-License-Identifier: Apache-2.0
// Photographs in a folder and their masks, before a build; measures of single photographs. Needs ibr::author.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "ibr/image.h"

namespace ibr {

struct PhotographFolder {
  struct UnreadableFile {
    std::string name;
    std::string reason;  // for people: the fault, and what to do
  };
  std::vector<std::string> pictures;       // content and extension of JPEG, PNG or TIFF files
  std::vector<UnreadableFile> unreadable;  // photographs by name or content in unsupported formats, or damaged
};

/// Names are relative to the folder (with '/'), sorted. Subfolders are searched, links to folders are not.
/// Skipped silently: hidden files and folders (._IMG_1.jpg), scenes, other programs' preview folders, and files
/// beside an image that differ only in the extension (IMG_1.CR2 beside IMG_1.JPG). Throws
/// std::filesystem::filesystem_error.
PhotographFolder scanPhotographFolder(const std::filesystem::path& folder);

/// Returns one line that names the files, at most three per reason; "" if there are none.
std::string unreadableText(const std::vector<PhotographFolder::UnreadableFile>& unreadable);

/// File of a photograph's mask in COLMAP's format: of a/b.jpg, a/b.jpg.png or a/b.png below `folder`. nullopt if there
/// is none.
std::optional<std::filesystem::path> findMaskFile(const std::filesystem::path& folder, const std::string& photograph);

/// Reads a JPEG, PNG or TIFF file as 8-bit sRGB of three channels, as stored: EXIF's orientation is not applied, alpha
/// is dropped. Throws Error (io, invalidInput, unsupported) that names the file.
Image8 readPicture(const std::filesystem::path& file);

/// Scales RGB down by area averaging.
Image8 downscaled(const Image8& picture, int width, int height);

/// Luma of RGB, one channel.
Image8 toGrey(const Image8& picture);

}  // namespace ibr
