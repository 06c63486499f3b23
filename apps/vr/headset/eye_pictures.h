// SPDX-License-Identifier: Apache-2.0
// Both eyes' pictures as files: NAME_l.png and NAME_r.png, with view and settings inside
// (shared/draw/picture_record.h), so that `ibr render SCENE --poses NAME_l.png --stereo` draws them again.
#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "ibr/camera.h"
#include "ibr/image.h"

namespace ibr::app {

/// The first view_0001.png, view_0002.png … of the folder that neither eye has yet.
std::filesystem::path freePicture(const std::filesystem::path& folder);

/// `file`: NAME.png, of which the eyes' are made, which are given back. Folders are made. Throws Error{io}.
std::array<std::filesystem::path, 2> writeEyes(const std::filesystem::path& file, const std::array<Image8, 2>& pictures,
                                               const std::vector<Camera>& eyes, nlohmann::ordered_json settings);

}  // namespace ibr::app
