// SPDX-License-Identifier: Apache-2.0
#include "batch/build/cell_figures.h"

#include <cmath>

namespace ibr::app {

double meanOf(const OptimiseSceneReport& report, double (*figure)(const OptimisedCell&)) {
  double sum = 0, count = 0;
  for (const OptimisedCell& cell : report.cells) {
    const double value = figure(cell);
    if (std::isnan(value)) continue;
    sum += value;
    ++count;
  }
  return count > 0 ? sum / count : std::nan("");
}

AlignmentCycle sumOf(const std::vector<AlignmentCycle>& cycles) {
  AlignmentCycle sum;
  for (const AlignmentCycle& cycle : cycles) {
    sum.mutations += cycle.mutations;
    sum.pixels += cycle.pixels;
    sum.moved += cycle.moved;
    sum.refused += cycle.refused;
    sum.flipped += cycle.flipped;
    sum.inserted += cycle.inserted;
    sum.seconds += cycle.seconds;
  }
  return sum;
}

}  // namespace ibr::app
