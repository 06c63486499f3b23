// SPDX-License-Identifier: Apache-2.0
// Cameras that agree better: what all pictures say about one another, put into poses and focal lengths.
#pragma once

#include <span>
#include <vector>

#include "author/htm/htm_views.h"

namespace ibr {

struct AdjustedCamera {
  Camera camera;
  double beforePx = 0, afterPx = 0;  // RMS distance between where it sees the vertices and where it should
  bool adjusted = false;             // false: too few vertices, or no better
  bool known = false;                // enough vertices to tell
};

/// Cameras that see each vertex `offsets` px (consensusOffsets: n_c × n_v) from where those given do, as well as a pose
/// and a focal length can (least squares; principal points and the ratio of focal lengths stay). Vertices count for the
/// cameras of which they are members. The mesh stays where it is, so that the cameras' mean error stays.
std::vector<AdjustedCamera> adjustedCameras(const TriangleMesh& mesh, std::span<const HtmView> views,
                                            std::span<const CameraSet> members, std::span<const glm::vec2> offsets);

}  // namespace ibr
