// SPDX-License-Identifier: Apache-2.0
#include "batch/inspect/unused_photographs.h"

#include "shared/report/table.h"

namespace ibr::app {

std::string unusedText(const std::vector<UnusedPhotograph>& unused) {
  if (unused.empty()) return "every photograph is used\n";
  Table table;
  table.row({"unused photograph", "why"});
  for (const auto& [name, reason] : unused) table.row({name, reason});
  return table.text() + "\n";
}

nlohmann::ordered_json unusedJson(const std::vector<UnusedPhotograph>& unused) {
  auto list = nlohmann::ordered_json::array();
  for (const auto& [name, reason] : unused) list.push_back({{"name", name}, {"reason", reason}});
  return list;
}

}  // namespace ibr::app
