// SPDX-License-Identifier: Apache-2.0
// How far the camera moved between two frames of a video, by the points that both show.
#pragma once

#include <span>

#include "author/video/frame_measure.h"

namespace ibr {

/// In parts of the longer side of a frame.
struct FrameMotion {
  double shift = 0;     // median movement of the shared points
  double parallax = 0;  // median movement that no rotation of the camera explains
  double shared = 0;    // number of shared points over the smaller number of points
};

/// `width`, `height`: of the frames, px. The rotation is fitted for a lens whose focal length is 0.85 of the longer
/// side, which telephones have about. Fewer than 12 shared points: `shared` is 0.
FrameMotion motionBetween(std::span<const TrackedPoint> from, std::span<const TrackedPoint> to, int width, int height);

}  // namespace ibr
