// SPDX-License-Identifier: Apache-2.0
// Chooses frames of a video by sharpness and motion, from measures of all its frames.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "author/video/frame_measure.h"

namespace ibr {

struct MeasuredVideo {
  std::span<const FrameMeasure> frames;
  int width = 0, height = 0;   // of the measured frames, px
  double framesPerSecond = 0;  // mean
};

/// Sharpness of each frame, 0 to 1: its detail relative to the largest detail of the frames within half a second, in
/// the direction in which it has least. Motion blurs along one direction only.
std::vector<double> relativeSharpness(const MeasuredVideo& video);

/// Numbers of the frames to use, ascending. `wanted`: about how many; 0: 40 to 80 a minute where the camera moves, by
/// motion: neighbours are a parallax of 3 % of the longer side apart, or a shift of 20 %.
std::vector<std::size_t> chooseFrames(const MeasuredVideo& video, std::span<const double> sharpness,
                                      std::size_t wanted);

}  // namespace ibr
