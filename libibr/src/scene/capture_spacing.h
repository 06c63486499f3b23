// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "ibr/camera.h"

namespace ibr {

/// b: median over the cameras of the distance to the nearest one at another place, world units; 1 where all are at one
/// place. Places less than 1e-6 of the cameras' extent apart are the same.
double captureSpacing(std::span<const Camera> cameras);

}  // namespace ibr
