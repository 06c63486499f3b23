// SPDX-License-Identifier: Apache-2.0
// Photographs in a folder and their masks, before a build; measures of single photographs. Needs ibr::author.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "ibr/image.h"

namespace ibr {

/// Files of a folder, by kind.
struct PhotographFolder {
  /// A photograph that cannot be read.
  struct UnreadableFile {
    std::string name;    // relative to the folder
    std::string reason;  // the fault and what to do, for people
  };
  std::vector<std::string> pictures;       // photographs by extension and content
  std::vector<UnreadableFile> unreadable;  // photographs by name or content in unsupported formats, or damaged
  std::vector<std::string> videos;         // videos by extension, without those beside a photograph of the same name
  std::size_t doubles = 0;  // number of photographs left out: links to files of the folder; of photographs of one name,
                            // such as IMG_1.JPG, IMG_1.HEIC and IMG_1.DNG, all but the first of these kinds
  std::size_t others = 0;   // number of files of other kinds
};

/// Finds JPEG, PNG, TIFF, HEIC, AVIF, WebP and raw photographs. Names are relative to the folder (with '/'), sorted.
/// Subfolders are searched, also behind links; a folder that is reached twice is searched once. Skipped without being
/// counted: hidden files and folders (._IMG_1.jpg), scenes, other programs' preview folders. Throws
/// std::filesystem::filesystem_error.
PhotographFolder scanPhotographFolder(const std::filesystem::path& folder);

/// Returns one line with the numbers of photographs and of files left out.
std::string countText(const PhotographFolder& folder);

/// Returns one line that names the files, at most three per reason; "" if there are none.
std::string unreadableText(const std::vector<PhotographFolder::UnreadableFile>& unreadable);

/// Returns the file of a photograph's mask in COLMAP's format: of a/b.jpg, a/b.jpg.png or a/b.png below `folder`.
/// nullopt if there is none.
std::optional<std::filesystem::path> findMaskFile(const std::filesystem::path& folder, const std::string& photograph);

/// Reads a photograph as 8-bit sRGB of three channels, as stored: EXIF's orientation is not applied, alpha is dropped.
/// The program ibr-decode reads HEIC, AVIF, WebP and raw files. Throws Error (io, invalidInput, unsupported) that names
/// the file.
Image8 readPicture(const std::filesystem::path& file);

/// Scales RGB down to width × height by area averaging.
Image8 downscaled(const Image8& picture, int width, int height);

/// Returns the luma of an RGB image, one channel.
Image8 toGrey(const Image8& picture);

}  // namespace ibr
