// SPDX-License-Identifier: Apache-2.0
// Pictures of the place without the interface.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "ibr/gpu_scene.h"
#include "ibr/image.h"
#include "viewer/open/open_item.h"

namespace ibr::app {

/// FOLDER/NAME_0001.png, say, or the first such number that is free: no video and no folder has it either.
std::filesystem::path freeFile(const std::filesystem::path& folder, const char* name, const char* extension);

/// All that makes one picture of a view of the place, as `ibr render` reports it.
nlohmann::ordered_json settingsOf(const OpenItem& place, const GpuSceneOptions& gpuScene);

/// Writes what `ibr render` writes for the same view and settings. Throws Error{io}.
void writeScreenshot(const std::filesystem::path& file, const Image8& image, const OpenItem& place, VkExtent2D extent,
                     const GpuSceneOptions& gpuScene);

}  // namespace ibr::app
