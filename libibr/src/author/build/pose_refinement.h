// SPDX-License-Identifier: Apache-2.0
// Refines poses and focal lengths by the dense matches of a first round of cells.
//
// A pose error affects all pixels: a rotation by half a pixel costs more than the errors that matching leaves. A pose
// estimator uses some hundred points per photograph; the cells match every textured surface.
//
//   1. tracks from the cells' matches (dense_tracks.h) and from the model, which connect photographs that share no cell
//   2. bundle adjustments (bundle_adjust.h), in px of the matched size, in three steps: poses by the model's tracks;
//      poses by the cells' tracks too; intrinsics too. Photographs that share intrinsics still do afterwards. Lenses
//      with distortion keep their intrinsics, since their photographs were undistorted with them
//   3. a step is accepted only if, fitted to half of the points, it fits the other half better by 3 standard errors,
//      both for the cells' and for the model's points (cross_validation.h). Dense matches are biased towards the poses
//      they were made with, and their errors are correlated; alone they would move good poses
//   4. a similarity moves the cameras back: origin, orientation and scale of the world are kept
#pragma once

#include <vector>

#include "author/build/build_input.h"
#include "ibr/author/build.h"
#include "ibr/scene.h"

namespace ibr {

/// Changes cameras and track points of `input`. `cells`: of a scene of its photographs. Photographs without tracks and
/// panoramas keep their poses; all do if no step is accepted. Single-threaded.
PoseRefinement refinePoses(BuildInput& input, const std::vector<Cell>& cells);

}  // namespace ibr
