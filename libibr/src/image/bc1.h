// SPDX-License-Identifier: Apache-2.0
// Blocks of BC1 ([T] §2.6.3, eq. 19; Khronos Data Format Specification 1.3, "S3TC"): 16 pixels in 8 bytes.
//
// Two colours of 5:6:5 bits and a 2-bit selector per pixel: one of the two, or of two colours between them. The order
// of the two endpoints, as numbers, selects the block's mode. The encoder only writes four-colour mode, in which the
// first is greater.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace ibr {

using BlockPixels = std::array<std::array<std::uint8_t, 4>, 16>;  // RGBA, row by row

inline constexpr std::size_t kBc1BlockBytes = 8;

/// Ignores alpha. Deterministic. A block of one colour decodes to within 2 levels per channel.
void encodeBc1(const BlockPixels& pixels, std::span<std::byte, kBc1BlockBytes> block) noexcept;

/// Decodes both modes; alpha is 255 (three-colour mode gives black for the transparent selector).
BlockPixels decodeBc1(std::span<const std::byte, kBc1BlockBytes> block) noexcept;

}  // namespace ibr
