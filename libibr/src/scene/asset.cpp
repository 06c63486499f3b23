// SPDX-License-Identifier: Apache-2.0
#include "ibr/asset.h"

#include "base/file.h"
#include "ibr/htm_sequence.h"
#include "scene/htm_model_file.h"
#include "scene/json_check.h"
#include "scene/scene_file.h"

namespace ibr {
namespace fs = std::filesystem;

std::optional<AssetKind> assetKind(const fs::path& path) noexcept {
  try {
    if (fs::is_directory(path)) {
      if (fs::is_regular_file(path / kSceneFileName)) return AssetKind::scene;
      if (fs::is_regular_file(path / kHtmModelFileName)) return AssetKind::htmModel;
      if (fs::is_regular_file(path / kHtmSequenceFileName)) return AssetKind::htmSequence;
      return std::nullopt;
    }
    const nlohmann::json document = parseJson(readTextFile(path));
    if (document.contains("frames") && document.contains("fps")) return AssetKind::htmSequence;
    const nlohmann::json& extensions = document.at("extensions");
    if (extensions.contains(kSceneExtension)) return AssetKind::scene;
    if (extensions.contains(kHtmModelExtension)) return AssetKind::htmModel;
  } catch (const std::exception&) {
  }
  return std::nullopt;
}

}  // namespace ibr
