// SPDX-License-Identifier: Apache-2.0
#include "shared/json/json_text.h"

#include <nlohmann/json.hpp>

namespace ibr::app {

using Json = nlohmann::ordered_json;

std::string jsonText(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

std::string jsonLine(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json jsonOrDiscarded(std::string_view text) {
  return Json::parse(text, nullptr, false);
}

}  // namespace ibr::app
