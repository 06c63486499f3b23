// SPDX-License-Identifier: Apache-2.0
// Blocks of BC7, mode 6 (Khronos Data Format Specification 1.3, "BPTC"): 16 pixels in 16 bytes.
//
// Mode 6 is one line in RGBA: two endpoints of 7 bits per channel, plus a p-bit that an endpoint's channels share. Each
// pixel has a 4-bit index of 16 points on the line. Photographs gain little from the seven other modes.
#pragma once

#include "image/bc1.h"

namespace ibr {

inline constexpr std::size_t kBc7BlockBytes = 16;

/// Alpha counts as much as a colour. Deterministic. A block of one colour decodes exactly, or within 1 level if both 0
/// and 255 are among its channels.
void encodeBc7(const BlockPixels& pixels, std::span<std::byte, kBc7BlockBytes> block) noexcept;

/// Decodes exactly as specified. For a block of another mode returns false and leaves `pixels` unchanged.
bool decodeBc7(std::span<const std::byte, kBc7BlockBytes> block, BlockPixels& pixels) noexcept;

}  // namespace ibr
