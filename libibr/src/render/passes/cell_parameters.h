// SPDX-License-Identifier: Apache-2.0
// From a planned cell in double precision to what the cell pass reads: everything relative to the virtual camera, so
// that the GPU never sees a world coordinate.
#pragma once

#include "render/passes/steps.h"
#include "shared/cell.h"

namespace ibr {

shader::CellParameters cellParameters(const FramePlan& plan, std::size_t view, const Step& step) noexcept;

/// The gains of the step's photographs as the frame shows them; the same from all its views.
shader::CellExposure cellExposure(const FramePlan& plan, const Step& step) noexcept;

}  // namespace ibr
