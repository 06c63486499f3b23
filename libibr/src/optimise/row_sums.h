// SPDX-License-Identifier: Apache-2.0
// Sums over runs of pixels of a row, in a portable way and in AVX2: equal bit for bit.
#pragma once

#include <array>
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

/// Sums in the making: eight lanes of 32 bits each, products in halves of 16 bits, so that nothing is widened in
/// between. The portable way leaves them alone.
struct alignas(32) RunLanes {
  enum Sum { x0, x1, x2, y0, y1, y2, xxLow, xxHigh, yyLow, yyHigh, xyLow, xyHigh, kSums };
  std::array<std::array<std::int32_t, 8>, kSums> lanes{};
  int steps = 0;  // that were added since the lanes were empty, each at most 2¹⁷ a lane
};

/// One way to add runs; the pixels of a run are at most kEccRun.
struct RunAdder {
  void (*add)(const RunSource& source, const RunSource& target, int pixels, shader::EccTarget& sums, RunLanes& lanes);
  void (*finish)(shader::EccTarget& sums, RunLanes& lanes);  // after the last run
};

extern const RunAdder kPortableRunAdder;

/// The fastest that this processor has.
const RunAdder& fastestRunAdder();

}  // namespace ibr
