// SPDX-License-Identifier: Apache-2.0
// Photographs that a file of poses names, as found in a folder.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "ibr/author/poses.h"

namespace ibr {

/// Finds photographs by the paths that other programs wrote: absolute paths, paths relative to another folder, paths
/// with '\', and names without extension.
class PhotographFinder {
 public:
  /// An empty path, or one that is no folder: nothing is found.
  explicit PhotographFinder(std::filesystem::path folder) : folder_(std::move(folder)) {}

  const std::filesystem::path& folder() const { return folder_; }

  /// Name, relative to the folder, of the photograph with this path: the longest end of the path that exists in the
  /// folder, with or without extension; else the only photograph of this file name; else the only one of this stem.
  std::optional<std::string> find(const std::string& path);
  /// The same of the whole path alone, relative to the folder.
  std::optional<std::string> findExact(const std::string& path) const;

 private:
  void scan();

  std::filesystem::path folder_;
  bool scanned_ = false;
  std::map<std::string, std::vector<std::string>> byFile_, byStem_;  // names relative to the folder
};

/// Name of an image whose photograph is not known: `path` with '/' for '\'; of an absolute path, and of one that leads
/// upwards, only the file name.
std::string plainName(const std::string& path);

/// Gives all images the names of their photographs, sorts the images, and removes points without observations. An image
/// gets no photograph that another one names exactly; without a photograph, it gets its plainName(), or keeps a name
/// that is relative to the folder of the photographs. Throws Error{invalidInput} if two images share a name or a
/// photograph.
void nameAndSort(PosedModel& model, const std::filesystem::path& file, PhotographFinder& photographs,
                 bool namesAreRelative = false);

}  // namespace ibr
