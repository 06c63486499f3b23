// SPDX-License-Identifier: Apache-2.0
// Sums over a run of pixels of one row, in a portable way and in AVX2: equal bit for bit.
#pragma once

#include <cstdint>

#include "shared/ecc.h"

namespace ibr {

/// Where one photograph is read along a run. Coordinates in 2⁻²² px from the first texel's upper left neighbour.
struct RunSource {
  const std::uint32_t* texel;  // its word
  int stride;                  // words
  std::int32_t x, y;           // of the first pixel, >= 0
  std::int32_t stepX, stepY;   // to the next
};

using AddRun = void (*)(const RunSource& source, const RunSource& target, int pixels, shader::EccTarget& sums);

/// At most kEccRun pixels.
void addRunPortable(const RunSource& source, const RunSource& target, int pixels, shader::EccTarget& sums);

/// The fastest of this processor.
AddRun fastestAddRun();

}  // namespace ibr
