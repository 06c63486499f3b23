// SPDX-License-Identifier: Apache-2.0
#include "shared/cli/near_name.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <utility>
#include <vector>

namespace ibr::app {
namespace {

// Optimal string alignment distance: the number of single errors that turn one word into the other.
std::size_t typingErrors(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before, last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before = std::exchange(last, row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row[b.size()];
}

}  // namespace

std::optional<std::string> nearName(std::string_view word, std::span<const std::string> names) {
  const auto letters = std::size_t(std::ranges::count_if(word, [](char c) { return c != '-'; }));
  std::size_t fewest = std::min<std::size_t>(2, letters / 3) + 1;
  std::optional<std::string> near;
  for (const std::string& name : names) {
    const std::size_t errors = typingErrors(word, name);
    if (errors == 0) return std::nullopt;
    if (errors >= fewest) continue;
    fewest = errors;
    near = name;
  }
  return near;
}

std::optional<std::string> misspeltOption(const CLI::App& command, std::span<const char* const> arguments) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  for (const std::string_view argument : arguments) {
    if (!argument.starts_with("--")) continue;
    const std::string_view word = argument.substr(0, argument.find('='));
    if (const auto near = nearName(word, names))
      return fmt::format("{} is not an option; did you mean {}?", word, *near);
  }
  return std::nullopt;
}

}  // namespace ibr::app
