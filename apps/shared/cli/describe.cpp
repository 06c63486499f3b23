// SPDX-License-Identifier: Apache-2.0
#include "shared/cli/describe.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "shared/cli/context.h"
#include "shared/cli/exit_code.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

Json namesOf(const std::set<CLI::Option*>& options) {
  Json names = Json::array();
  for (const CLI::Option* option : options) names.push_back(option->get_name());
  return names;
}

Json describe(const CLI::Option& option) {
  Json names = Json::array();
  for (const std::string& name : option.get_snames()) names.push_back('-' + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  const bool argument = names.empty();
  if (argument) names.push_back(option.get_name());
  const bool flag = !argument && option.get_items_expected_max() == 0;
  Json json{{"names", names},
            {"argument", argument},
            {"flag", flag},
            {"type", flag ? std::string() : option.get_type_name()},
            {"description", option.get_description()},
            {"heading", option.get_group()}};
  if (option.get_required()) json["required"] = true;
  if (option.get_expected_max() > 1) json["repeated"] = true;
  if (!option.get_needs().empty()) json["needs"] = namesOf(option.get_needs());
  if (!option.get_excludes().empty()) json["excludes"] = namesOf(option.get_excludes());
  return json;
}

}  // namespace

Json describeOptions(const CLI::App& app) {
  Json options = Json::array();
  for (const CLI::Option* option : app.get_options())
    if (!option->get_group().empty()) options.push_back(describe(*option));
  return options;
}

Json describeExitCodes() {
  Json codes = Json::array();
  for (const auto& [code, meaning] : kExitCodes) codes.push_back({{"code", int(code)}, {"meaning", meaning}});
  return codes;
}

void printDescription(const Json& json) {
  std::fputs((json.dump(1) + '\n').c_str(), stdout);
  flushResults();
}

}  // namespace ibr::app
