// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ibr/camera.h"
#include "ibr/image.h"

namespace ibr {

/// Inverse depth along a pinhole's axis: one channel, `camera` has the map's size; kUnknownDepth
/// (author/backdrop/complete_depth.h) where unknown.
struct DepthMap {
  Camera camera;
  ImageF inverseDepth;
};

}  // namespace ibr
