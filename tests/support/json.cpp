// SPDX-License-Identifier: Apache-2.0
#include "support/json.h"

#include <nlohmann/json.hpp>

namespace ibr::test {

nlohmann::json parseJson(std::string_view text) {
  return nlohmann::json::parse(text);
}

nlohmann::ordered_json parseOrderedJson(std::string_view text) {
  return nlohmann::ordered_json::parse(text);
}

std::string jsonLine(const nlohmann::json& json) {
  return json.dump();
}

std::string jsonLine(const nlohmann::ordered_json& json) {
  return json.dump();
}

}  // namespace ibr::test
