// SPDX-License-Identifier: Apache-2.0
// Images that show the effect of optimising a cell ([T] figs 18 and 19).
#pragma once

#include <filesystem>

#include "ibr/author/optimise_scene.h"

namespace ibr::app {

/// Compares a cell in two versions of a scene; writes below `folder`:
///   cellNNN_before.png, cellNNN_after.png  the morph half-way between the cell's photographs: their mean
///                      in tier 0, the first photograph alone in tier 1
///   cellNNN_heat.png   both images side by side under the mesh and the points' ECC: 1 clear, then yellow, 0 red
///   cellNNN_crops.png  before and after, enlarged, at the largest changes: at most four rows
/// In cells of panoramas the image has the first member's camera orientation. Throws Error.
void writeOptimisePictures(const Scene& before, const Scene& after, const OptimisedCell& facts,
                           const std::filesystem::path& folder);

}  // namespace ibr::app
