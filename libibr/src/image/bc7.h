// SPDX-License-Identifier: Apache-2.0
// Blocks of BC7, mode 6 (Khronos Data Format Specification 1.3, "BPTC"): 16 pixels in 16 bytes.
//
// One line in RGBA: two endpoints of 7 bits a channel, each with one more bit that its channels share (its p-bit), and
// a 4-bit choice a pixel among 16 points of the line. Photographs gain little from the seven other modes.
#pragma once

#include "image/bc1.h"

namespace ibr {

inline constexpr std::size_t kBc7BlockBytes = 16;

/// Alpha counts as much as a colour. Deterministic. A block of one colour comes back exactly, or within 1 level where
/// both 0 and 255 are among its channels.
void encodeBc7(const BlockPixels& pixels, std::span<std::byte, kBc7BlockBytes> block) noexcept;

/// Exactly as the specification says. False, and `pixels` as they were, for a block of another mode.
bool decodeBc7(std::span<const std::byte, kBc7BlockBytes> block, BlockPixels& pixels) noexcept;

}  // namespace ibr
