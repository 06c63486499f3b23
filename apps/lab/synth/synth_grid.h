// SPDX-License-Identifier: Apache-2.0
// A scene of any number of photographs, to measure memory and streaming.
#pragma once

#include "ibr/scene.h"
#include "shared/camera/camera_path.h"

namespace ibr::app {

/// Repeats the first photograph and mesh of `corner`: a scene at infinity with one cell of three photographs that look
/// in one direction. The result has side² photographs a metre apart on the ground, and two cells in each square. The
/// truth is unchanged.
Scene gridScene(const Scene& corner, int side);

/// Returns a path from one corner of the grid to the opposite one, at 3 m/s.
CameraPath gridWalk(int side, int width, int height);

}  // namespace ibr::app
