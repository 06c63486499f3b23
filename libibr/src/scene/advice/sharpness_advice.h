// SPDX-License-Identifier: Apache-2.0
// Finds photographs that are soft compared with their neighbours.
#pragma once

#include <cstdint>
#include <vector>

#include "ibr/advice.h"

namespace ibr {

/// Compares the sharpness (ibr/metrics.h) of the textures in the scene's folder, at 1600 px or less. Skips nodes whose
/// texture cannot be read, and scenes without a folder. `neighbours`: for each node the nodes that share a cell with
/// it.
std::vector<Advice> sharpnessAdvice(const Scene& scene, const std::vector<std::vector<std::uint32_t>>& neighbours);

}  // namespace ibr
