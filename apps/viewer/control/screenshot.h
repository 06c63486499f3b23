// SPDX-License-Identifier: Apache-2.0
// Screenshots of the scene without the interface.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "ibr/gpu_scene.h"
#include "ibr/image.h"
#include "viewer/open/open_item.h"

namespace ibr::app {

/// Returns FOLDER/NAME_0001.png, or the first number for which no such file, folder or .mp4 exists.
std::filesystem::path freeFile(const std::filesystem::path& folder, const char* name, const char* extension);

/// Returns all settings that determine the image, in the format that `ibr render` reports.
nlohmann::ordered_json settingsOf(const OpenItem& item, const GpuSceneOptions& gpuScene);

/// Writes the same image file as `ibr render` for the same view and settings. Throws Error{io}.
void writeScreenshot(const std::filesystem::path& file, const Image8& image, const OpenItem& item, VkExtent2D extent,
                     const GpuSceneOptions& gpuScene);

}  // namespace ibr::app
