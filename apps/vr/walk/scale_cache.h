// SPDX-License-Identifier: Apache-2.0
// Cached scales: world units per metre by scene, as the user set them. {"version":1,"scales":{"/path/of/scene":0.37}}.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "ibr/log.h"

namespace ibr::app {

class ScaleCache {
 public:
  /// An empty path: nothing is stored. An unreadable file counts as empty, with a warning in the log.
  ScaleCache(const std::filesystem::path& file, LogCallback log);

  std::optional<double> of(const std::filesystem::path& scene) const;

  /// Writes the whole file. Errors go to the log as warnings.
  void store(const std::filesystem::path& scene, double unitsPerMetre);

 private:
  void warn(const std::string& text) const;

  std::filesystem::path file_;
  LogCallback log_;
  std::map<std::string, double> scales_;  // by canonical path
};

}  // namespace ibr::app
