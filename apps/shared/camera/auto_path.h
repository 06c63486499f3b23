// SPDX-License-Identifier: Apache-2.0
// Automatic camera path through the positions of the photographs.
#pragma once

#include "ibr/scene.h"
#include "shared/camera/camera_path.h"

namespace ibr::app {

/// Returns a tour of the cells' centres, or of the photographs if there are no cells. The tour is smoothed, so it leads
/// between the photographs, and extends a tenth of a cell's reach beyond both ends. `frames` of the path gives
/// `frameCount` views. The view turns with the photographs, is upright, and is narrower than the photographs by the
/// share that the cells cover. Width and height 0: the photographs' size, even, at most 1280 px. Throws
/// Error{invalidInput} if there is no photograph.
CameraPath autoPath(const Scene& scene, int frameCount, int width = 0, int height = 0);

}  // namespace ibr::app
