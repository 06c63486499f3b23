// SPDX-License-Identifier: Apache-2.0
// Compares a plan with the options of its renderer.
#pragma once

#include "ibr/renderer.h"

namespace ibr {

/// Returns the field of RendererOptions that the plan exceeds; nullptr: none. Pure; does not allocate.
const char* exceededOption(const FramePlan& plan, const RendererOptions& options) noexcept;
/// The same for a target.
const char* exceededOption(const Target& target, const RendererOptions& options) noexcept;

}  // namespace ibr
