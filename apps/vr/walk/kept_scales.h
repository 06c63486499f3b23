// SPDX-License-Identifier: Apache-2.0
// How many world units a metre has in each scene, as its user left it: {"version":1,"scales":{"/path/of/scene":0.37}}.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "ibr/log.h"

namespace ibr::app {

class KeptScales {
 public:
  /// An empty path: nothing is kept. What cannot be read counts as empty, and the log is told.
  KeptScales(const std::filesystem::path& file, LogCallback log);

  std::optional<double> of(const std::filesystem::path& scene) const;

  /// Writes the file, whole. Where that fails the log is told.
  void keep(const std::filesystem::path& scene, double unitsPerMetre);

 private:
  void warn(const std::string& text) const;

  std::filesystem::path file_;
  LogCallback log_;
  std::map<std::string, double> scales_;  // by canonical path
};

}  // namespace ibr::app
