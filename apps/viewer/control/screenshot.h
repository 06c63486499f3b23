// SPDX-License-Identifier: Apache-2.0
// Screenshots of the scene without the interface.
#pragma once

#include <filesystem>

#include "ibr/gpu_scene.h"
#include "ibr/image.h"
#include "shared/draw/picture_record.h"
#include "shared/draw/picture_writer.h"
#include "viewer/open/open_item.h"

namespace ibr::app {

/// Returns FOLDER/NAME_0001.png, or the first number for which no such file, folder or .mp4 exists.
std::filesystem::path freeFile(const std::filesystem::path& folder, const char* name, const char* extension);

/// Returns all settings that determine the image, in the format that `ibr render` reports.
nlohmann::ordered_json settingsOf(const OpenItem& item, const GpuSceneOptions& gpuScene);

/// Returns the record of the current view.
PictureRecord recordOf(const OpenItem& item, VkExtent2D extent, const GpuSceneOptions& gpuScene);

/// Returns a job that writes the same image file as `ibr render` for the same view and settings. `opaque`: the file has
/// no alpha. Without a file, the job takes freeFile(folder, "view", ".png").
PictureJob screenshotJob(const std::filesystem::path& file, const std::filesystem::path& folder, Image8 image,
                         bool opaque, PictureRecord record);

}  // namespace ibr::app
