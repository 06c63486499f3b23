// SPDX-License-Identifier: Apache-2.0
// From a planned cell in double precision to what the cell pass reads: everything relative to the virtual camera, so
// that the GPU never sees a world coordinate.
#pragma once

#include <span>

#include "ibr/renderer.h"
#include "shared/cell.h"

namespace ibr {

/// Tier kTierAgrees: the planned weights. Tier kTierRejected: the best member alone, in position and in colour, so that
/// a triangle whose members disagree cannot ghost. `cameras`: of the cell's members; `layers`: of their photographs in
/// their array images.
shader::CellParameters cellParameters(const FramePlan& plan, const PlannedCell& planned,
                                      std::span<const Camera> cameras, std::span<const std::uint32_t> layers,
                                      Tier tier) noexcept;

}  // namespace ibr
