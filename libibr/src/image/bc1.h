// SPDX-License-Identifier: Apache-2.0
// Blocks of BC1 ([T] §2.6.3, eq. 19; Khronos Data Format Specification 1.3, "S3TC"): 16 pixels in 8 bytes.
//
// Two colours of 5:6:5 bits and a 2-bit choice a pixel among them and the two colours between. The order of the two
// says which mode a block is in; only the mode of four colours is written, in which the first is the greater as a
// number.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace ibr {

using BlockPixels = std::array<std::array<std::uint8_t, 4>, 16>;  // RGBA, row by row

inline constexpr std::size_t kBc1BlockBytes = 8;

/// Alpha is ignored. Deterministic. A block of one colour comes back within 2 levels in each channel.
void encodeBc1(const BlockPixels& pixels, std::span<std::byte, kBc1BlockBytes> block) noexcept;

/// Both modes; alpha is 255 (the mode of three colours has black where others have nothing).
BlockPixels decodeBc1(std::span<const std::byte, kBc1BlockBytes> block) noexcept;

}  // namespace ibr
