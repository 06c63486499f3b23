// SPDX-License-Identifier: Apache-2.0
#include "shared/cli/setting_arguments.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "shared/cli/settings.h"
#include "shared/json/json_text.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

// Turns renderScale into --render-scale.
std::string optionOf(const std::string& key) {
  std::string option = "--";
  for (const char c : key) {
    if (c >= 'A' && c <= 'Z')
      option += {'-', char(c - 'A' + 'a')};
    else
      option += c;
  }
  return option;
}

std::string optionValue(const Json& value) {
  if (!value.is_array()) return value.is_string() ? value.get<std::string>() : jsonLine(value);
  std::string list;
  for (const Json& one : value) {
    if (!list.empty()) list += ",";
    list += optionValue(one);
  }
  return list;
}

}  // namespace

std::vector<std::string> settingArguments(const Json& settings) {
  const Json defaults = optionsJson({});
  std::vector<std::string> words;
  for (const auto& [key, value] : settings.items()) {
    if (std::ranges::count(kMeasuredSettings, key) > 0 && value == defaults[key]) continue;
    if (value.is_null() || value == false || (value.is_array() && value.empty())) continue;
    words.push_back(optionOf(key));
    if (value != true) words.push_back(optionValue(value));
  }
  return words;
}

}  // namespace ibr::app
