// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "base/file.h"

namespace ibr::test {

/// Returns the contents of all files below a folder, by their path relative to the folder.
inline std::map<std::string, std::string> contentsBelow(const std::filesystem::path& folder) {
  std::map<std::string, std::string> contents;
  if (std::filesystem::exists(folder))
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
      if (entry.is_regular_file())
        contents[std::filesystem::relative(entry.path(), folder).string()] = readTextFile(entry.path());
  return contents;
}

}  // namespace ibr::test
