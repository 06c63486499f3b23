// SPDX-License-Identifier: Apache-2.0
#include "batch/inspect/unused_photographs.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace ibr::app {

std::string unusedText(const std::vector<UnusedPhotograph>& unused) {
  if (unused.empty()) return "every photograph is used\n";
  constexpr std::size_t kShown = 5;
  std::string text = fmt::format("unused photographs: {}\n", unused.size());
  for (std::size_t i = 0; i < std::min(unused.size(), kShown); ++i)
    text += fmt::format("  {}: {}\n", unused[i].name, unused[i].reason);
  if (unused.size() > kShown) text += fmt::format("  and {} more (--json lists them)\n", unused.size() - kShown);
  return text;
}

nlohmann::ordered_json unusedJson(const std::vector<UnusedPhotograph>& unused) {
  auto list = nlohmann::ordered_json::array();
  for (const auto& [name, reason] : unused) list.push_back({{"name", name}, {"reason", reason}});
  return list;
}

}  // namespace ibr::app
