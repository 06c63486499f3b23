// SPDX-License-Identifier: Apache-2.0
// Depth levels of a plane sweep: one step moves the members by about one pixel relative to each other.
#pragma once

#include <span>
#include <vector>

#include "ibr/camera.h"

namespace ibr {

/// Depth levels as inverse depths along the frame's axis: from 0 (infinity) upwards.
struct SweepLevels {
  std::vector<double> inverseDepth;  // ascending
  double step = 0;                   // between levels among the tracks; towards infinity the steps grow
  double evenFrom = 0;               // inverse depth from which on steps are constant

  int count() const { return int(inverseDepth.size()); }
  /// Interpolates linearly between levels. Precondition: 0 <= level <= count() − 1.
  double at(double level) const;
};

/// Returns levels from infinity to well in front of the nearest tracks. Precondition: at least one inverse depth, all
/// of them positive.
SweepLevels sweepLevels(const Camera& frame, std::span<const Camera> members, std::vector<double> trackInverseDepths);

}  // namespace ibr
