// SPDX-License-Identifier: Apache-2.0
// Writes both eyes' images as NAME_l.png and NAME_r.png, with view and settings as metadata
// (shared/draw/picture_record.h). `ibr render SCENE --poses NAME_l.png --stereo` draws them again.
#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "ibr/camera.h"
#include "ibr/image.h"

namespace ibr::app {

/// Returns the first of view_0001.png, view_0002.png … in the folder for which no file of either eye exists.
std::filesystem::path freePicture(const std::filesystem::path& folder);

/// `file`: NAME.png; the eyes' file names derive from it and are returned. Creates folders. Throws Error{io}.
std::array<std::filesystem::path, 2> writeEyes(const std::filesystem::path& file, const std::array<Image8, 2>& pictures,
                                               const std::array<Camera, 2>& eyes, nlohmann::ordered_json settings);

}  // namespace ibr::app
