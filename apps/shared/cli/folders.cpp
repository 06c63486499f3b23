// SPDX-License-Identifier: Apache-2.0
#include "shared/cli/folders.h"

#include <cstdlib>
#include <fstream>
#include <string>

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

fs::path fromEnvironment(const char* variable) {
  const char* given = std::getenv(variable);
  return given ? given : "";
}

// Returns $XDG_…_HOME, else the subfolder `below` of the home folder. Empty: neither variable is set.
fs::path baseFolder(const char* variable, const char* below) {
  const fs::path given = fromEnvironment(variable), home = fromEnvironment("HOME");
  return !given.empty() || home.empty() ? given : home / below;
}

fs::path ours(const fs::path& base) {
  if (base.empty()) return {};
  std::error_code error;
  fs::create_directories(base / "libibr", error);
  return error ? fs::path() : base / "libibr";
}

// Parses lines such as XDG_PICTURES_DIR="$HOME/Pictures" in user-dirs.dirs; "$HOME" alone means no folder.
fs::path userPicturesFolder() {
  const std::string key = "XDG_PICTURES_DIR=\"", home = "$HOME/";
  std::ifstream file(baseFolder("XDG_CONFIG_HOME", ".config") / "user-dirs.dirs");
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with(key)) continue;
    std::string value = line.substr(key.size(), line.rfind('"') - key.size());
    if (value.starts_with(home)) {
      value.erase(0, home.size());
      return value.empty() ? fs::path() : fromEnvironment("HOME") / value;
    }
    return value;
  }
  return {};
}

}  // namespace

fs::path settingsFolder() {
  return ours(baseFolder("XDG_CONFIG_HOME", ".config"));
}
fs::path cacheFolder() {
  return ours(baseFolder("XDG_CACHE_HOME", ".cache"));
}

fs::path picturesFolder() {
  std::error_code ignored;
  for (const fs::path& pictures : {userPicturesFolder(), fromEnvironment("HOME") / "Pictures"})
    if (pictures.is_absolute() && fs::is_directory(pictures, ignored)) return pictures / "ibr";
  return fs::current_path(ignored);
}

std::string folderName(const fs::path& path) {
  const fs::path whole = fs::absolute(path).lexically_normal();
  return (whole.has_filename() ? whole : whole.parent_path()).filename().string();
}

}  // namespace ibr::app
