// SPDX-License-Identifier: Apache-2.0
#include "scene/json_check.h"

#include <fmt/format.h>

#include <cmath>
#include <set>
#include <vector>

namespace ibr {
namespace {

using Json = nlohmann::json;

constexpr int kDeepest = 64;

std::string escaped(std::string_view key) {
  std::string result;
  for (const char c : key) {
    if (c == '~') {
      result += "~0";
    } else if (c == '/') {
      result += "~1";
    } else {
      result += c;
    }
  }
  return result;
}

}  // namespace

Json parseJson(std::string_view text) {
  std::vector<std::set<std::string>> keys;  // of the objects that are open
  const auto watch = [&](int depth, Json::parse_event_t event, Json& parsed) {
    if (depth > kDeepest) throw JsonFault("", fmt::format("is nested deeper than {} levels", kDeepest));
    if (event == Json::parse_event_t::object_start) keys.emplace_back();
    if (event == Json::parse_event_t::object_end) keys.pop_back();
    if (event == Json::parse_event_t::key && !keys.back().insert(parsed.get<std::string>()).second)
      throw JsonFault("", fmt::format("the key \"{}\" stands twice in one object", parsed.get<std::string>()));
    return true;
  };
  try {
    return Json::parse(text.begin(), text.end(), watch);
  } catch (const Json::exception& e) {
    throw JsonFault("", fmt::format("is not valid JSON: {}", e.what()));
  }
}

bool JsonValue::has(const char* key) const {
  if (!value_->is_object()) fault("is not an object");
  return value_->contains(key);
}

JsonValue JsonValue::operator[](const char* key) const {
  if (!has(key)) fault(fmt::format("has no \"{}\"", key));
  return JsonValue(value_->at(key), pointer_ + '/' + escaped(key));
}

JsonValue JsonValue::at(std::size_t index) const {
  if (index >= size()) fault(fmt::format("has {} elements, none at {}", size(), index));
  return JsonValue((*value_)[index], fmt::format("{}/{}", pointer_, index));
}

std::size_t JsonValue::size() const {
  if (!value_->is_array()) fault("is not an array");
  return value_->size();
}

double JsonValue::number() const {
  if (!value_->is_number()) fault("is not a number");
  const double number = value_->get<double>();
  if (!std::isfinite(number)) fault("is not finite");
  return number;
}

std::int64_t JsonValue::integer(std::int64_t low, std::int64_t high) const {
  if (!value_->is_number_integer()) fault(fmt::format("{} is not a whole number", value_->dump()));
  const bool large = value_->is_number_unsigned() && value_->get<std::uint64_t>() > std::uint64_t(INT64_MAX);
  if (large || value_->get<std::int64_t>() < low || value_->get<std::int64_t>() > high)
    fault(fmt::format("{} is not within {} to {}", value_->dump(), low, high));
  return value_->get<std::int64_t>();
}

std::size_t JsonValue::index(std::size_t count) const {
  if (count == 0) fault("refers to an element of an empty list");
  return std::size_t(integer(0, std::int64_t(count) - 1));
}

std::string JsonValue::string() const {
  if (!value_->is_string()) fault("is not a string");
  return value_->get<std::string>();
}

}  // namespace ibr
