// SPDX-License-Identifier: Apache-2.0
#include "vr/walk/scale_cache.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/check.h"
#include "base/file.h"
#include "ibr/error.h"
#include "shared/json/json_text.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

constexpr std::uint64_t kMaxFileBytes = 1 << 20;

std::string keyOf(const fs::path& scene) {
  std::error_code failed;
  const fs::path whole = fs::weakly_canonical(scene, failed);
  return ((failed ? scene : whole) / "").parent_path().string();  // without trailing slash
}

bool isScale(double value) {
  return std::isfinite(value) && value > 0;
}

}  // namespace

ScaleCache::ScaleCache(const fs::path& file, LogCallback log) : file_(file), log_(std::move(log)) {
  std::error_code unknown;
  if (file_.empty() || !fs::exists(file_, unknown)) return;
  try {
    const std::vector<std::byte> bytes = readFile(file_, kMaxFileBytes);
    const auto* text = reinterpret_cast<const char*>(bytes.data());
    const nlohmann::ordered_json cached = jsonOrDiscarded({text, bytes.size()});
    check(!cached.is_discarded(), ErrorCode::invalidInput, "{}: is not JSON", file_.string());
    for (const auto& [scene, scale] : cached.at("scales").items())
      if (scale.is_number() && isScale(scale.get<double>())) scales_[scene] = scale.get<double>();
  } catch (const std::exception& e) {
    warn(e.what());
  }
}

std::optional<double> ScaleCache::of(const fs::path& scene) const {
  const auto found = scales_.find(keyOf(scene));
  return found == scales_.end() ? std::nullopt : std::optional(found->second);
}

void ScaleCache::store(const fs::path& scene, double unitsPerMetre) {
  if (file_.empty() || !isScale(unitsPerMetre)) return;
  scales_[keyOf(scene)] = unitsPerMetre;
  try {
    writeFile(file_, jsonText({{"version", 1}, {"scales", scales_}}));
  } catch (const Error& e) {
    warn(e.what());
  }
}

void ScaleCache::warn(const std::string& text) const {
  if (log_) log_(LogLevel::warning, "scales are not saved: " + text);
}

}  // namespace ibr::app
