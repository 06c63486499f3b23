// SPDX-License-Identifier: Apache-2.0
#include "shared/json/json_text.h"

#include <nlohmann/json.hpp>

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

std::string jsonText(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

std::string jsonLine(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json parsedJson(std::string_view text) {
  return Json::parse(text, nullptr, false);
}

}  // namespace ibr::app
