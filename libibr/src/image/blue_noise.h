// SPDX-License-Identifier: Apache-2.0
// Tileable blue noise by the void-and-cluster method (Ulichney, "The void-and-cluster method for dither array
// generation", SPIE 1913, 1993). Used for dithering ([T] §2.5.1).
#pragma once

#include <cstdint>
#include <vector>

namespace ibr {

/// Returns size × size ranks, rows from the top: each of 0 … size²−1 once; tiles in both directions. Deterministic for
/// a seed. Precondition: 8 <= size <= 128 (time grows with size⁴: about 0.1 s at 64).
std::vector<std::uint16_t> blueNoise(int size, std::uint64_t seed);

}  // namespace ibr
