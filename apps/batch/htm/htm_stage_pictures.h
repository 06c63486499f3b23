// SPDX-License-Identifier: Apache-2.0
// Meshes at the stages of harmonising, coloured by the inconsistency of their textures ([H] fig. 9).
#pragma once

#include <filesystem>

#include "ibr/author/htm.h"

namespace ibr::app {

/// Returns a colour ramp: blue at D_f = 0, then green and yellow, red at `most` 8-bit levels and above.
glm::u8vec3 differenceColour(double difference, double most);

/// Writes below `folder` a PLY with face colours for each stage, and a PNG with all stages side by side as seen by
/// `camera`, shaded. Red is the 99 % quantile of the original mesh's differences.
void writeStages(const std::filesystem::path& folder, const std::vector<HtmResult::Stage>& stages,
                 const Camera& camera);

}  // namespace ibr::app
