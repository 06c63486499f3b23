// SPDX-License-Identifier: Apache-2.0
#include "viewer/control/screenshot.h"

#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "base/file.h"
#include "shared/cli/htm_view_settings.h"
#include "shared/cli/settings.h"
#include "shared/draw/image_operations.h"

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

PictureRecord recordOf(const OpenItem& item, VkExtent2D extent, const GpuSceneOptions& gpuScene) {
  return {cameraOf(item, extent), item.video ? std::optional(item.time) : std::nullopt, settingsOf(item, gpuScene)};
}

PictureJob screenshotJob(const fs::path& file, const fs::path& folder, Image8 image, bool opaque,
                         PictureRecord record) {
  const auto picture = std::make_shared<const Image8>(std::move(image));
  return {.name = file.empty() ? folder.string() : file.string(), .write = [=, record = std::move(record)] {
            const fs::path written = file.empty() ? freeFile(folder, "view", ".png") : file;
            if (written.has_parent_path()) makeFolders(written.parent_path());
            writePicture(written, opaque ? rgb(*picture) : *picture, record);
            return std::vector{written};
          }};
}

}  // namespace ibr::app
