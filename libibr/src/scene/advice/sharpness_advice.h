// SPDX-License-Identifier: Apache-2.0
// Which photographs are soft beside their neighbours.
#pragma once

#include <cstdint>
#include <vector>

#include "ibr/advice.h"

namespace ibr {

/// Looks at the textures of the scene's folder, at 1600 px or less (image/sharpness.h); nodes whose texture cannot be
/// read are passed over, as are all of a scene without a folder. `mates`: for each node those that share a cell with
/// it.
std::vector<Advice> sharpnessAdvice(const Scene& scene, const std::vector<std::vector<std::uint32_t>>& mates);

}  // namespace ibr
