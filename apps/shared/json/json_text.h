// SPDX-License-Identifier: Apache-2.0
// JSON to and from text. Compiled once: the templates of the JSON library take seconds in each source.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace ibr::app {

/// Returns indented text with a final newline. Bytes that are not UTF-8 become U+FFFD.
std::string jsonText(const nlohmann::ordered_json& json);

/// Returns text on one line, without a newline. Bytes that are not UTF-8 become U+FFFD.
std::string jsonLine(const nlohmann::ordered_json& json);

/// Parses text; returns a discarded value (is_discarded()) for text that is not JSON.
nlohmann::ordered_json jsonOrDiscarded(std::string_view text);

}  // namespace ibr::app
