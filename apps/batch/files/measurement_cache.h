// SPDX-License-Identifier: Apache-2.0
// Cache of a command's measurements: a file with one JSON value a line, each with a key of all its inputs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace ibr::app {

class MeasurementCache {
 public:
  /// Reads the file, if there is one; damaged lines are dropped. Throws Error{io}.
  explicit MeasurementCache(std::filesystem::path file);

  std::optional<nlohmann::ordered_json> find(std::uint64_t key) const;

  /// Adds a line and writes the file before returning; the file on disk is complete at any time. Throws Error{io}.
  void add(std::uint64_t key, const nlohmann::ordered_json& json);

 private:
  std::filesystem::path file_;
  std::map<std::string, nlohmann::ordered_json> byKey_;
};

}  // namespace ibr::app
