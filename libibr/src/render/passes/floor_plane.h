// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ibr/renderer.h"
#include "shared/floor.h"

namespace ibr {

/// Returns the plan's floor as a view sees it; fadeRadius is 0 if the plan has no floor.
shader::FloorConstants floorConstants(const FramePlan& plan, std::size_t view) noexcept;

}  // namespace ibr
