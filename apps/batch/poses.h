// SPDX-License-Identifier: Apache-2.0
// Where views come from, and what their pictures are called.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "batch/options.h"
#include "ibr/log.h"
#include "ibr/scene.h"
#include "shared/camera_path.h"

namespace ibr::app {

/// `poses`: a COLMAP model's folder, or a camera path. A size other than 0 replaces that of the poses: the vertical
/// field of view stays and pixels keep their shape. Throws Error.
std::vector<View> readViews(const std::filesystem::path& poses, PictureSize size, const LogCallback& log);

/// A folder that holds a COLMAP model (cameras, images, points3D as .txt or .bin).
bool holdsColmapModel(const std::filesystem::path& folder);

/// The file below `folder` for the picture of a view: its name, with ".png" for the extension of an image file. Throws
/// Error{invalidInput} for a name that leads out of the folder.
std::filesystem::path pictureFile(const std::filesystem::path& folder, const std::string& viewName);

/// Throws Error{invalidInput} where two views would have the same picture file.
void checkNamesDiffer(const std::vector<View>& views);

}  // namespace ibr::app
