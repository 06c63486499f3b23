// SPDX-License-Identifier: Apache-2.0
#include "batch/files/measurement_cache.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "base/file.h"
#include "shared/json/json_text.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

std::string nameOf(std::uint64_t key) {
  return fmt::format("{:016x}", key);
}

}  // namespace

MeasurementCache::MeasurementCache(std::filesystem::path file) : file_(std::move(file)) {
  if (!std::filesystem::exists(file_)) return;
  std::istringstream lines(readTextFile(file_));
  for (std::string line; std::getline(lines, line);) {
    const Json json = jsonOrDiscarded(line);
    if (!json.is_object() || !json.contains("key") || !json["key"].is_string()) continue;
    byKey_[json["key"].get<std::string>()] = json;
  }
}

std::optional<Json> MeasurementCache::find(std::uint64_t key) const {
  const auto found = byKey_.find(nameOf(key));
  return found == byKey_.end() ? std::nullopt : std::optional(found->second);
}

void MeasurementCache::add(std::uint64_t key, const Json& json) {
  Json line{{"key", nameOf(key)}};
  line.update(json);
  byKey_[nameOf(key)] = std::move(line);
  std::string text;
  for (const auto& [name, measurement] : byKey_) text += jsonLine(measurement) + '\n';
  writeFile(file_, text);
}

}  // namespace ibr::app
