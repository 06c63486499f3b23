// SPDX-License-Identifier: Apache-2.0
#include "shared/cli/typed_path.h"

#include <algorithm>
#include <cstdlib>
#include <vector>

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

std::vector<std::string> foldersWithPrefix(const fs::path& parent, const std::string& beginning) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator it(parent.empty() ? "." : parent, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    std::error_code unknown;
    const bool meant = name.starts_with(beginning) && (name[0] != '.' || !beginning.empty());
    if (meant && it->is_directory(unknown)) names.push_back(name);
  }
  return names;
}

// Cuts at the start of a UTF-8 character.
void backToLetter(std::string& text, std::size_t end) {
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  text.resize(end);
}

}  // namespace

fs::path typedPath(const std::string& text) {
  constexpr const char* kWhite = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(kWhite);
  if (begin == std::string::npos) return {};
  const std::string meant = text.substr(begin, text.find_last_not_of(kWhite) - begin + 1);
  const char* home = std::getenv("HOME");
  const bool atHome = meant == "~" || meant.starts_with("~/");
  return atHome && home ? fs::path(home + meant.substr(1)) : fs::path(meant);
}

std::string completedFolder(const std::string& text) {
  const fs::path typed = typedPath(text);
  const std::string beginning = typed.filename().string();
  const std::vector<std::string> names = foldersWithPrefix(typed.parent_path(), beginning);
  if (names.empty()) return text;
  std::string common = names[0];
  for (const std::string& name : names) {
    const std::size_t end = std::size_t(std::ranges::mismatch(common, name).in1 - common.begin());
    if (end < common.size()) backToLetter(common, end);
  }
  return text + common.substr(beginning.size()) + (names.size() == 1 ? "/" : "");
}

}  // namespace ibr::app
