// SPDX-License-Identifier: Apache-2.0
#include "scene/json_check.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "base/stop.h"

namespace ibr {
namespace {

using Json = nlohmann::json;

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

// Builds the document from the parser's events. The parser's own callbacks would take time quadratic in the length of a
// list.
class Builder {
 public:
  Builder(Json& document, const std::stop_token& stop) : document_(&document), stop_(stop) {}

  bool null() { return add(nullptr); }
  bool boolean(bool value) { return add(value); }
  bool number_integer(Json::number_integer_t value) { return add(value); }
  bool number_unsigned(Json::number_unsigned_t value) { return add(value); }
  bool number_float(Json::number_float_t value, const std::string&) { return add(value); }
  bool string(std::string& value) { return add(std::move(value)); }
  bool binary(Json::binary_t&) { return false; }  // not part of JSON text
  bool start_object(std::size_t) { return open(Json::object()); }
  bool start_array(std::size_t) { return open(Json::array()); }
  bool end_object() { return close(); }
  bool end_array() { return close(); }
  bool key(std::string& key) {
    levels_.back().key = key;
    const auto [member, isNew] = levels_.back().value->emplace(std::move(key), nullptr);
    if (!isNew) throw JsonFault(pointer(), "occurs twice in one object");
    member_ = &member.value();
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const Json::exception& e) {
    throw JsonFault(pointer(), fmt::format("is not valid JSON: {}", e.what()));
  }

 private:
  struct Level {
    Json* value;
    std::string key;  // the last one of an object
  };

  Json* place(Json&& value) {
    constexpr std::size_t kMaxValues = std::size_t(1) << 25;
    constexpr std::size_t kValuesPerCheck = 4096;
    if (++values_ > kMaxValues) throw JsonFault(pointer(), fmt::format("has more than {} values", kMaxValues));
    if (values_ % kValuesPerCheck == 0) checkStop(stop_, "reading JSON");
    if (levels_.empty()) return &(*document_ = std::move(value));
    Json& parent = *levels_.back().value;
    return parent.is_array() ? &parent.emplace_back(std::move(value)) : &(*member_ = std::move(value));
  }
  bool add(Json&& value) {
    place(std::move(value));
    return true;
  }
  bool open(Json&& value) {
    constexpr std::size_t kMaxDepth = 64;
    if (levels_.size() >= kMaxDepth)
      throw JsonFault(pointer(), fmt::format("is nested deeper than {} levels", kMaxDepth));
    levels_.push_back({place(std::move(value)), {}});
    return true;
  }
  bool close() {
    levels_.pop_back();
    return true;
  }
  // Pointer to the value that is being read.
  std::string pointer() const {
    std::string result;
    for (std::size_t i = 0; i < levels_.size(); ++i) {
      const bool innermost = i + 1 == levels_.size();
      result += '/';
      if (levels_[i].value->is_object())
        result += escaped(levels_[i].key);
      else
        result += fmt::format("{}", levels_[i].value->size() - (innermost ? 0 : 1));
    }
    return result;
  }

  Json* document_;
  const std::stop_token& stop_;
  std::vector<Level> levels_;
  Json* member_ = nullptr;
  std::size_t values_ = 0;
};

// Appends the pointer of `wanted` below `from`; returns false if it is not there.
bool findPointer(const Json& from, const Json* wanted, std::string& pointer) {
  if (&from == wanted) return true;
  const std::size_t length = pointer.size();
  if (from.is_object()) {
    for (auto member = from.begin(); member != from.end(); ++member) {
      pointer += '/' + escaped(member.key());
      if (findPointer(*member, wanted, pointer)) return true;
      pointer.resize(length);
    }
  } else if (from.is_array()) {
    for (std::size_t i = 0; i < from.size(); ++i) {
      pointer += fmt::format("/{}", i);
      if (findPointer(from[i], wanted, pointer)) return true;
      pointer.resize(length);
    }
  }
  return false;
}

// Text of a value for a message; summarises lists and objects, which might be the whole document.
std::string shown(const Json& value) {
  if (value.is_structured()) return fmt::format("an {} of {} elements", value.type_name(), value.size());
  std::string text = value.dump();
  constexpr std::size_t kMaxBytes = 100;
  if (text.size() > kMaxBytes) text = text.substr(0, kMaxBytes) + "…";
  return text;
}

}  // namespace

Json parseJson(std::string_view text, const std::stop_token& stop) {
  Json document;
  Builder builder(document, stop);
  Json::sax_parse(text.begin(), text.end(), &builder);
  return document;
}

std::string JsonValue::pointer() const {
  std::string pointer;
  findPointer(*document_, value_, pointer);
  return pointer;
}

bool JsonValue::has(const char* key) const {
  if (!value_->is_object()) fault(fmt::format("{} is not an object", shown(*value_)));
  return value_->contains(key);
}

JsonValue JsonValue::operator[](const char* key) const {
  if (!value_->is_object()) fault(fmt::format("{} is not an object", shown(*value_)));
  const auto member = value_->find(key);
  if (member == value_->end()) fault(fmt::format("has no \"{}\"", key));
  return JsonValue(*document_, *member);
}

JsonValue JsonValue::at(std::size_t index) const {
  if (index >= size()) fault(fmt::format("has {} elements, but no element {}", size(), index));
  return JsonValue(*document_, (*value_)[index]);
}

std::size_t JsonValue::size() const {
  if (!value_->is_array()) fault(fmt::format("{} is not an array", shown(*value_)));
  return value_->size();
}

double JsonValue::number() const {
  if (!value_->is_number()) fault(fmt::format("{} is not a number", shown(*value_)));
  const double number = value_->get<double>();
  if (!std::isfinite(number)) fault("is not finite");
  return number;
}

std::int64_t JsonValue::integer(std::int64_t low, std::int64_t high) const {
  if (!value_->is_number_integer()) fault(fmt::format("{} is not a whole number", shown(*value_)));
  const bool large = value_->is_number_unsigned() && value_->get<std::uint64_t>() > std::uint64_t(INT64_MAX);
  if (large || value_->get<std::int64_t>() < low || value_->get<std::int64_t>() > high)
    fault(fmt::format("{} is not within {} to {}", shown(*value_), low, high));
  return value_->get<std::int64_t>();
}

std::size_t JsonValue::index(std::size_t count) const {
  if (count == 0) fault("refers to an element of an empty list");
  return std::size_t(integer(0, std::int64_t(count) - 1));
}

std::string JsonValue::string() const {
  if (!value_->is_string()) fault(fmt::format("{} is not a string", shown(*value_)));
  return value_->get<std::string>();
}

}  // namespace ibr
