// SPDX-License-Identifier: Apache-2.0
// The meshes of a harmonised model's making, coloured by how inconsistent their textures are ([H] fig. 9).
#pragma once

#include <filesystem>

#include "ibr/htm_author.h"

namespace ibr::app {

/// Blue where D_f is 0, by way of green and yellow to red at `most` levels and beyond.
glm::u8vec3 differenceColour(double difference, double most);

/// Below `folder`: a PLY with face colours of each stage, and a PNG of them side by side as `camera` sees them, shaded.
/// Red is the level that 1 % of the original's faces exceed.
void writeStages(const std::filesystem::path& folder, const std::vector<HtmResult::Stage>& stages,
                 const Camera& camera);

}  // namespace ibr::app
