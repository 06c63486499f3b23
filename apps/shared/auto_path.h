// SPDX-License-Identifier: Apache-2.0
// A camera path made from where the photographs were taken.
#pragma once

#include "ibr/scene.h"
#include "shared/camera_path.h"

namespace ibr::app {

/// A tour of the places where photographs of a cell were taken (of all photographs, where there is no cell), smoothed,
/// so that it leads between them, and a tenth of a step beyond the first and the last. `frames` of it gives
/// `frameCount` views. The view turns with the photographs, is held upright and is a little narrower than they are. A
/// size of 0 is that of the photographs, at most 1280 px and even. Throws Error{invalidInput} where the scene has no
/// pinhole node.
CameraPath autoPath(const Scene& scene, int frameCount, int width = 0, int height = 0);

}  // namespace ibr::app
