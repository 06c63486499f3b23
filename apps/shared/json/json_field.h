// SPDX-License-Identifier: Apache-2.0
// Strict reader for JSON from outside. Every message names the source and the path of the value in the JSON.
#pragma once

#include <fmt/format.h>

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "base/check.h"

namespace ibr::app {

/// Throws Error{invalidInput} that begins with `name`: not JSON, nesting deeper than 8, or a repeated key in an object.
nlohmann::ordered_json parseJson(const std::string& text, const std::string& name);

/// Value with its name in messages: "NAME: /keys/3/time". The JSON must outlive it. All throw Error{invalidInput}.
class JsonField {
 public:
  JsonField(const nlohmann::ordered_json& json, std::string path) : json_(json), path_(std::move(path)) {}
  /// The root value of the JSON from `name`.
  static JsonField whole(const nlohmann::ordered_json& json, const std::string& name) { return {json, name + ": "}; }

  bool has(const char* key) const;
  JsonField at(const char* key) const;
  JsonField at(std::size_t i) const;
  /// Number of elements of an array, from `minSize` to `maxSize`.
  std::size_t size(std::size_t minSize, std::size_t maxSize) const;
  double number(double low, double high) const;
  int integer(int low, int high) const;
  std::string text() const;
  const nlohmann::ordered_json& json() const { return json_; }

  /// Throws "PLACE: is VALUE, but must be WHAT" if `holds` is false.
  template <class... Args>
  void wanted(bool holds, fmt::format_string<Args...> what, Args&&... args) const {
    if (!holds) refuse(fmt::format(what, std::forward<Args>(args)...));
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const;

  const nlohmann::ordered_json& json_;
  std::string path_;
};

}  // namespace ibr::app
