// SPDX-License-Identifier: Apache-2.0
// Sums over runs of pixels in a row, in a portable version and in AVX2: equal bit for bit.
#pragma once

#include <array>
#include <cstdint>

#include "shared/ecc.h"

namespace ibr {

/// Reads of one photograph along a run. Coordinates in 2⁻²² px from the first texel's upper left neighbour.
struct RunSource {
  const std::uint32_t* texel;  // word of the first texel
  int stride;                  // words
  std::int32_t x, y;           // of the first pixel, >= 0
  std::int32_t stepX, stepY;   // to the next
};

/// Partial sums: eight lanes of 32 bits each, products split into halves of 16 bits to avoid widening in the loop. The
/// portable version does not use them.
struct RunLanes {
  enum Sum { x0, x1, x2, y0, y1, y2, xxLow, xxHigh, yyLow, yyHigh, xyLow, xyHigh, kSums };
  std::array<std::array<std::int32_t, 8>, kSums> lanes{};
  int steps = 0;  // since the lanes were emptied, each at most 2¹⁷ per lane
};

/// A version of the run sums; a run has at most kEccRun pixels.
struct RunAdder {
  void (*add)(const RunSource& source, const RunSource& target, int pixels, shader::EccTarget& sums, RunLanes& lanes);
  void (*finish)(shader::EccTarget& sums, RunLanes& lanes);  // after the last run
};

extern const RunAdder kPortableRunAdder;

/// Fastest version that this processor supports.
const RunAdder& fastestRunAdder();

}  // namespace ibr
