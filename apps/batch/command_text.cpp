// SPDX-License-Identifier: Apache-2.0
#include "batch/command_text.h"

#include <algorithm>
#include <cctype>
#include <string_view>

namespace fs = std::filesystem;

namespace ibr::app {

std::string commandText(const std::string& command, const std::vector<std::string>& words) {
  std::string text = command;
  for (const std::string& word : words) {
    const bool plain = !word.empty() && std::ranges::all_of(word, [](unsigned char c) {
      return c > 0x7f || std::isalnum(c) || std::string_view("_./:=,+-").find(char(c)) != std::string_view::npos;
    });
    std::string quoted = "'";
    for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    text += " " + (plain ? word : quoted + "'");
  }
  return text;
}

bool isInside(const fs::path& folder, const fs::path& of) {
  const fs::path way = fs::weakly_canonical(folder).lexically_relative(fs::weakly_canonical(of));
  return !way.empty() && *way.begin() != "..";
}

}  // namespace ibr::app
