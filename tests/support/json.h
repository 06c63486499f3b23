// SPDX-License-Identifier: Apache-2.0
// JSON of tests. Compiled once: the templates of the JSON library take seconds in each source.
#pragma once

#include <catch2/catch.hpp>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace ibr::test {

/// Parses text. Throws nlohmann::json::parse_error.
nlohmann::json parseJson(std::string_view text);
nlohmann::ordered_json parseOrderedJson(std::string_view text);

/// Returns text on one line.
std::string jsonLine(const nlohmann::json& json);
std::string jsonLine(const nlohmann::ordered_json& json);

}  // namespace ibr::test

namespace Catch {

template <>
struct StringMaker<nlohmann::json> {
  static std::string convert(const nlohmann::json& json) { return ibr::test::jsonLine(json); }
};
template <>
struct StringMaker<nlohmann::ordered_json> {
  static std::string convert(const nlohmann::ordered_json& json) { return ibr::test::jsonLine(json); }
};

}  // namespace Catch
