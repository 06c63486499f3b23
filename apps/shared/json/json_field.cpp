// SPDX-License-Identifier: Apache-2.0
#include "shared/json/json_field.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

namespace ibr::app {

using Json = nlohmann::ordered_json;

namespace {
constexpr int kMaxDepth = 8;
}

bool JsonField::has(const char* key) const {
  return json_.is_object() && json_.contains(key);
}

JsonField JsonField::at(const char* key) const {
  wanted(has(key), "an object with \"{}\"", key);
  return {json_[key], path_ + '/' + key};
}

JsonField JsonField::at(std::size_t i) const {
  return {json_[i], fmt::format("{}/{}", path_, i)};
}

std::size_t JsonField::size(std::size_t minSize, std::size_t maxSize) const {
  wanted(json_.is_array() && json_.size() >= minSize && json_.size() <= maxSize, "an array of {} to {} values", minSize,
         maxSize);
  return json_.size();
}

double JsonField::number(double low, double high) const {
  const double value = json_.is_number() ? json_.get<double>() : std::nan("");
  wanted(value >= low && value <= high, "a number from {} to {}", low, high);
  return value;
}

int JsonField::integer(int low, int high) const {
  const double value = number(low, high);
  wanted(value == std::floor(value), "a whole number");
  return int(value);
}

std::string JsonField::text() const {
  wanted(json_.is_string(), "a string");
  return json_.get<std::string>();
}

void JsonField::refuse(const std::string& what) const {
  std::string text = json_.dump(-1, ' ', true, Json::error_handler_t::replace);
  if (text.size() > 60) text = text.substr(0, 57) + "...";
  fail(ErrorCode::invalidInput, "{}: is {}, but must be {}", path_, text, what);
}

// Refuses repeated keys, of which nlohmann keeps the last. Limits the depth while parsing, before any recursion.
Json parseJson(const std::string& text, const std::string& name) {
  std::vector<std::vector<std::string>> open;
  const auto watch = [&](int depth, Json::parse_event_t event, Json& value) {
    check(depth <= kMaxDepth, ErrorCode::invalidInput, "{}: nested more than {} levels deep", name, kMaxDepth);
    if (event == Json::parse_event_t::object_start) open.emplace_back();
    if (event == Json::parse_event_t::object_end) open.pop_back();
    if (event == Json::parse_event_t::key) {
      const auto& key = value.get_ref<const std::string&>();
      check(std::ranges::find(open.back(), key) == open.back().end(), ErrorCode::invalidInput,
            "{}: duplicate key \"{}\"", name, key);
      open.back().push_back(key);
    }
    return true;
  };
  try {
    return Json::parse(text, watch);
  } catch (const Json::exception& e) {
    fail(ErrorCode::invalidInput, "{}: is not JSON: {}", name, e.what());
  }
}

}  // namespace ibr::app
