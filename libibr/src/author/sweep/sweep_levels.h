// SPDX-License-Identifier: Apache-2.0
// The depths that a plane sweep tries: spaced so that one step moves the members by about one pixel against each other.
#pragma once

#include <span>
#include <vector>

#include "ibr/camera.h"

namespace ibr {

/// The depths that are tried, as inverse depths along the frame's axis: from 0 (infinity) upwards.
struct SweepLevels {
  std::vector<double> inverseDepth;  // ascending
  double step = 0;                   // between levels among the tracks; towards infinity the steps grow
  double evenFrom = 0;               // inverse depth from which on they do not

  int count() const { return int(inverseDepth.size()); }
  /// Between levels by linear interpolation. Precondition: 0 <= level <= count() − 1.
  double at(double level) const;
};

/// Levels from infinity to well before the nearest tracks. Precondition: a track's inverse depth at least, all
/// positive.
SweepLevels sweepLevels(const Camera& frame, std::span<const Camera> members, std::vector<double> trackInverseDepths);

}  // namespace ibr
