// SPDX-License-Identifier: Apache-2.0
// Half floats (IEEE 754 binary16).
#pragma once

#include <cstdint>

namespace ibr {

/// Returns the nearest half float, ties to even; infinite from 65520 on. NaN stays NaN.
std::uint16_t toHalf(float value) noexcept;

/// Converts exactly.
float fromHalf(std::uint16_t half) noexcept;

}  // namespace ibr
