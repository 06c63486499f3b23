// SPDX-License-Identifier: Apache-2.0
// A scene of any number of photographs, to measure memory and streaming with.
#pragma once

#include "ibr/scene.h"
#include "shared/camera/camera_path.h"

namespace ibr::app {

/// From a scene at infinity with one cell of three photographs that look the same way: side² of them a metre apart on
/// the ground, two cells in each square, all with the picture and the mesh that the first has. The truth stays what it
/// was.
Scene gridScene(const Scene& corner, int side);

/// From one corner of the grid to the opposite one, at 3 m/s.
CameraPath gridWalk(int side, int width, int height);

}  // namespace ibr::app
