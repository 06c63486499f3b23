// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <stop_token>

#include "ibr/camera.h"

namespace ibr {

/// b: median distance from a camera to the nearest one at another capture site, world units; 1 if all are at one site.
/// Positions less than 1e-6 of the cameras' extent apart are one site. A requested stop throws Error{cancelled}.
/// Time is n log n in the number of cameras.
double captureSpacing(std::span<const Camera> cameras, const std::stop_token& stop = {});

}  // namespace ibr
