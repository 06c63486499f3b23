// SPDX-License-Identifier: Apache-2.0
#include "viewer/control/screenshot.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "shared/cli/htm_view_settings.h"
#include "shared/cli/settings.h"
#include "shared/draw/image_operations.h"
#include "shared/draw/picture_record.h"

namespace fs = std::filesystem;

namespace ibr::app {

fs::path freeFile(const fs::path& folder, const char* name, const char* extension) {
  for (int number = 1;; ++number) {
    const fs::path stem = folder / fmt::format("{}_{:04d}", name, number);
    const auto isFree = [&](const char* ending) { return !fs::exists(stem.string() + ending); };
    if (isFree(extension) && isFree("") && isFree(".mp4")) return stem.string() + extension;
  }
}

nlohmann::ordered_json settingsOf(const OpenItem& item, const GpuSceneOptions& gpuScene) {
  nlohmann::ordered_json settings =
      item.scene ? pictureSettingsJson(item.settings, gpuScene, {}) : htmSettingsJson(item.htmSettings, false);
  settings["graph"] = item.showGraph;
  return settings;
}

void writeScreenshot(const fs::path& file, const Image8& image, const OpenItem& item, VkExtent2D extent,
                     const GpuSceneOptions& gpuScene) {
  if (file.has_parent_path()) makeFolders(file.parent_path());
  const Camera camera = cameraOf(item, extent);
  const std::optional<double> time = item.video ? std::optional(item.time) : std::nullopt;
  writePicture(file, item.scene ? rgb(image) : image, {camera, time, settingsOf(item, gpuScene)});
}

}  // namespace ibr::app
