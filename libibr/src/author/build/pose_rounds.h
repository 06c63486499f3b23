// SPDX-License-Identifier: Apache-2.0
// Poses and focal lengths that agree better, by what the cells of a first round say about all photographs.
//
// An error of poses is one of every picture: a turn by half a pixel costs more than all that matching leaves. A pose
// estimator knows some hundred points a photograph; the cells know every textured place.
//
//   1. tracks of the cells' matches (dense_tracks.h), and the model's, which tie photographs that share no cell
//   2. bundle adjustments (bundle_adjust.h), in px of what is matched: poses by the model's tracks; by those of cells,
//      too; intrinsics, too. Photographs with the same intrinsics keep sharing them, those of lenses that distort keep
//      theirs, since their pictures are undistorted with them
//   3. each is taken only if, fitted to half of the points, it suits the other half better than what was taken before:
//      both what cells say and what the model says, by 3 standard errors (cross_validation.h). Dense matches lean
//      towards the poses that they were made with, and many err alike; alone they would move good poses
//   4. a similarity brings the cameras back onto where they were: place, direction and scale of the world stay
#pragma once

#include <vector>

#include "author/build/build_input.h"
#include "ibr/refine_poses.h"
#include "ibr/scene.h"

namespace ibr {

/// Changes cameras and the tracks' points of `input`; cells are those of a scene of its photographs. Photographs
/// without tracks, and panoramas, stay where they are; all do where no step is taken. Takes one thread.
PoseRefinement refinePoses(BuildInput& input, const std::vector<Cell>& cells);

}  // namespace ibr
