// SPDX-License-Identifier: Apache-2.0
// What a command measured before: a file of JSON, a line each, with a key of all that it depends on.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace ibr::app {

class KeptLines {
 public:
  /// Reads the file, if there is one; lines that are damaged are dropped. Throws Error{io}.
  explicit KeptLines(std::filesystem::path file);

  std::optional<nlohmann::ordered_json> find(std::uint64_t key) const;

  /// In the file before it returns; the file is always whole. Throws Error{io}.
  void add(std::uint64_t key, const nlohmann::ordered_json& json);

 private:
  std::filesystem::path file_;
  std::map<std::string, nlohmann::ordered_json> byKey_;
};

}  // namespace ibr::app
