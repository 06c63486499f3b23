// SPDX-License-Identifier: Apache-2.0
// Checked access to JSON: every getter checks kind and range, and reports the value's location.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <string_view>

namespace ibr {

/// A fault at a JSON pointer (RFC 6901).
class JsonFault : public std::runtime_error {
 public:
  JsonFault(std::string pointer, const std::string& message)
      : std::runtime_error(message), pointer_(std::move(pointer)) {}
  const std::string& pointer() const noexcept { return pointer_; }

 private:
  std::string pointer_;
};

/// Parses a text of at most 64 levels and 2^25 values without duplicate keys in objects. Throws JsonFault, with line
/// and column of a syntax error in the message. The same in every locale with a decimal point of one character. A
/// requested stop throws Error{cancelled} within some thousand values.
nlohmann::json parseJson(std::string_view text, const std::stop_token& stop = {});

/// A value and its location. Getters throw JsonFault. Cheap to copy; the document must outlive it.
class JsonValue {
 public:
  explicit JsonValue(const nlohmann::json& document) : JsonValue(document, document) {}

  std::string pointer() const;  // for messages; searches the document
  const nlohmann::json& raw() const { return *value_; }
  [[noreturn]] void fault(const std::string& message) const { throw JsonFault(pointer(), message); }

  bool has(const char* key) const;                                  // of an object
  JsonValue operator[](const char* key) const;                      // member of an object; a missing one is a fault
  JsonValue at(std::size_t index) const;                            // element of an array
  std::size_t size() const;                                         // of an array
  double number() const;                                            // finite
  std::int64_t integer(std::int64_t low, std::int64_t high) const;  // 3.0 is a fault
  std::size_t index(std::size_t count) const;                       // 0 … count − 1
  std::string string() const;

 private:
  JsonValue(const nlohmann::json& document, const nlohmann::json& value) : document_(&document), value_(&value) {}

  const nlohmann::json* document_;
  const nlohmann::json* value_;
};

}  // namespace ibr
