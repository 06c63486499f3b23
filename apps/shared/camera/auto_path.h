// SPDX-License-Identifier: Apache-2.0
// A camera path made from where the photographs were taken.
#pragma once

#include "ibr/scene.h"
#include "shared/camera/camera_path.h"

namespace ibr::app {

/// A tour of the cells' centres (of the photographs' places, where there is no cell), smoothed, so that it leads
/// between the photographs, and a tenth of a cell's reach beyond the first and the last of them. `frames` of it gives
/// `frameCount` views. The view turns with the photographs, is held upright, and is narrower than they are by as much
/// as the cells cover less than them. A size of 0 is that of the photographs, at most 1280 px and even. Throws
/// Error{invalidInput} where there is no photograph to visit.
CameraPath autoPath(const Scene& scene, int frameCount, int width = 0, int height = 0);

}  // namespace ibr::app
