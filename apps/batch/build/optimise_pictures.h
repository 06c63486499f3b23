// SPDX-License-Identifier: Apache-2.0
// What optimising a cell has changed, as pictures ([T] figs 18 and 19).
#pragma once

#include <filesystem>

#include "ibr/optimise_scene.h"

namespace ibr::app {

/// Writes, below `folder`, of a cell of two versions of a scene:
///   cellNNN_before.png, cellNNN_after.png  the picture half-way between its photographs: their mean
///                      in tier 0, the first one alone in tier 1
///   cellNNN_heat.png   both side by side under the mesh and the ECC of its points: 1 as it is, then yellow, red at 0
///   cellNNN_crops.png  before and after, enlarged, where that picture has changed most: at most four places, in rows
/// In cells of panoramas the picture is what the first one's camera would see half-way. Throws Error.
void writeOptimisePictures(const Scene& before, const Scene& after, const OptimisedCell& facts,
                           const std::filesystem::path& folder);

}  // namespace ibr::app
