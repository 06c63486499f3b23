// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ibr/camera.h"
#include "ibr/image.h"

namespace ibr {

/// Inverse depth along a pinhole's axis, 1 / world unit: one channel, kUnknownDepth where unknown
/// (author/backdrop/complete_depth.h). `camera` has the map's size.
struct DepthMap {
  Camera camera;
  ImageF inverseDepth;
};

}  // namespace ibr
