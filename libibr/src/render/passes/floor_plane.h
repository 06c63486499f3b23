// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ibr/renderer.h"
#include "shared/floor.h"

namespace ibr {

/// The plan's floor as a view sees it; without one fadeRadius is 0.
shader::FloorConstants floorConstants(const FramePlan& plan, std::size_t view) noexcept;

}  // namespace ibr
