// SPDX-License-Identifier: Apache-2.0
// Adjusts poses and focal lengths to the matches between all images.
#pragma once

#include <span>
#include <vector>

#include "author/htm/htm_views.h"

namespace ibr {

struct AdjustedCamera {
  Camera camera;
  double beforePx = 0, afterPx = 0;  // RMS distance between projected vertices and the positions wanted
  bool adjusted = false;             // false: too few vertices, or no improvement
  bool known = false;                // enough vertices to adjust the camera
};

/// Fits a pose and a focal length of each camera (least squares) so that vertices project `offsets` px
/// (consensusOffsets: n_c × n_v) from where they do. Principal points and the ratio of focal lengths are kept. A vertex
/// counts for the cameras of its `members`. The mesh is kept, and with it the cameras' mean error.
std::vector<AdjustedCamera> adjustedCameras(const TriangleMesh& mesh, std::span<const HtmView> views,
                                            std::span<const CameraSet> members, std::span<const glm::vec2> offsets);

}  // namespace ibr
