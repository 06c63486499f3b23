// SPDX-License-Identifier: Apache-2.0
// Converts a planned cell from double precision to the parameters of the cell pass. All are relative to the virtual
// camera, so that the GPU needs no world coordinate.
#pragma once

#include "render/passes/draw_list.h"
#include "shared/cell.h"

namespace ibr {

shader::CellParameters cellParameters(const FramePlan& plan, std::size_t view, const DrawItem& item) noexcept;

/// Returns the gains with which the frame shows the draw item's photographs; the same for all views.
shader::CellExposure cellExposure(const FramePlan& plan, const DrawItem& item) noexcept;

}  // namespace ibr
