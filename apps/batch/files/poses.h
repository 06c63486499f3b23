// SPDX-License-Identifier: Apache-2.0
// Where views come from, and what their pictures are called.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ibr/log.h"
#include "ibr/scene.h"
#include "shared/camera/camera_path.h"
#include "shared/cli/options.h"

namespace ibr::app {

/// `poses`: a COLMAP model's folder, transforms.json, a camera path, or a picture with its record inside, which names
/// the view; with `stereo` a picture NAME_l or NAME_r comes with the other eye's, which must lie beside it. Views of
/// cameras that distort are those of the undistorted photographs. A size other than 0 replaces that of the poses: the
/// vertical field of view stays and pixels keep their shape. Throws Error.
std::vector<View> readViews(const std::filesystem::path& poses, PictureSize size, const LogCallback& log,
                            bool stereo = false);

/// The vertical field of view a centred picture of the same height would have, in radians: focal lengths change, size,
/// shape of pixels and principal points stay. Precondition: 0 < fovY < π.
void setFov(std::vector<View>& views, double fovY);

/// The pictures that belong to one moment: one view, or the left and the right eye's.
using Frame = std::vector<View>;

/// A frame for each view, or with `stereo` for each pair: views NAME_l and NAME_r are eyes as they are, any other view
/// becomes NAME_l and NAME_r, half of `ipd` (world units, > 0) to either side. Throws Error{invalidInput} where one eye
/// of a pair is missing, and where an ipd is needed and 0.
std::vector<Frame> framesOf(const std::vector<View>& views, bool stereo, double ipd);

/// Whether views follow each other: those of a camera path do, and that of a picture is
/// at its own time. Throws Error{io}.
bool isWalk(const std::filesystem::path& poses);

/// A folder that holds a COLMAP model (cameras, images, points3D as .txt or .bin).
bool holdsColmapModel(const std::filesystem::path& folder);

/// The file below `folder` for the picture of a view: its name, with ".png" for the extension of an image file. Throws
/// Error{invalidInput} for a name that leads out of the folder.
std::filesystem::path pictureFile(const std::filesystem::path& folder, const std::string& viewName);

/// Throws Error{invalidInput} where two views would have the same picture file.
void checkNamesDiffer(const std::vector<View>& views);

}  // namespace ibr::app
