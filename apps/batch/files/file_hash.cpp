// SPDX-License-Identifier: Apache-2.0
#include "batch/files/file_hash.h"

#include <algorithm>
#include <vector>

namespace fs = std::filesystem;

namespace ibr::app {

void addFile(Hash& hash, const fs::path& file) {
  std::error_code ignored;
  hash.add(file.string());
  hash.add(std::uint64_t(fs::file_size(file, ignored)));
  hash.add(std::int64_t(fs::last_write_time(file, ignored).time_since_epoch().count()));
}

void addFolder(Hash& hash, const fs::path& folder) {
  std::vector<fs::path> files;
  if (!fs::is_directory(folder)) return addFile(hash, folder);
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) addFile(hash, file);
}

void addProgram(Hash& hash) {
  addFile(hash, fs::read_symlink("/proc/self/exe"));
}

}  // namespace ibr::app
