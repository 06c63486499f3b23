// SPDX-License-Identifier: Apache-2.0
// Reading of views from files, and names of their images.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ibr/log.h"
#include "ibr/scene.h"
#include "shared/camera/camera_path.h"
#include "shared/cli/options.h"

namespace ibr::app {

/// Reads views from poses in any format of readPoseFile, a camera path, or an image with a record, which names the
/// view. With `stereo`, an image NAME_l or NAME_r comes with the other eye's, which must be in the same folder.
/// Distorted cameras give the views of the undistorted photographs. A size other than 0 replaces the poses' size: the
/// vertical field of view is kept and pixels keep their shape. Throws Error.
std::vector<View> readViews(const std::filesystem::path& poses, PictureSize size, const LogCallback& log,
                            bool stereo = false);

/// Sets the vertical field of view, radians, that a centred image of the same height would have. Focal lengths change;
/// size, pixel shape and principal points are kept. Precondition: 0 < fovY < π.
void setFov(std::vector<View>& views, double fovY);

/// Views of one moment: one view, or the left and the right eye.
using Frame = std::vector<View>;

/// Returns a frame for each view, or with `stereo` for each pair. Views NAME_l and NAME_r are eyes already; any other
/// becomes NAME_l and NAME_r, half of `ipd` (world units, > 0) to either side. Throws Error{invalidInput} if an eye of
/// a pair is missing, or if an ipd is needed and is 0.
std::vector<Frame> framesOf(const std::vector<View>& views, bool stereo, double ipd);

/// True if the views have times: those of a camera path follow each other, and the view of an image has
/// its own time. Throws Error{io}.
bool isWalk(const std::filesystem::path& poses);

/// True if the folder holds a COLMAP model (cameras, images, points3D as .txt or .bin).
bool holdsColmapModel(const std::filesystem::path& folder);

/// Returns the file below `folder` for a view's image: the view's name, with ".png" for an image extension. Throws
/// Error{invalidInput} for a name that leads out of the folder.
std::filesystem::path pictureFile(const std::filesystem::path& folder, const std::string& viewName);

/// Throws Error{invalidInput} if two views would have the same image file.
void checkNamesDiffer(const std::vector<View>& views);

}  // namespace ibr::app
