// SPDX-License-Identifier: Apache-2.0
// How far apart photographs were taken.
#pragma once

#include <vector>

#include "ibr/camera.h"

namespace ibr {

/// b: median over the cameras of the distance to the nearest one at another place, world units; 1 where all are at one
/// place. Precondition: one camera at least.
double captureSpacing(const std::vector<Camera>& cameras);

}  // namespace ibr
