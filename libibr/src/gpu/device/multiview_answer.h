// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "ibr/device.h"

namespace ibr {

/// Result of the probe of gpu/draw/multiview.h on this device; empty: not probed. The address stays when the Device is
/// moved.
std::optional<bool>& multiviewAnswer(const Device& device) noexcept;

}  // namespace ibr
