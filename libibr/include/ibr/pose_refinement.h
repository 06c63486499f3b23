// SPDX-License-Identifier: Apache-2.0
// How poses changed when they were refined.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace ibr {

/// By bundle adjustment over the model's tracks and the matches of all cells, as far as points that it was not made
/// with confirm it, brought back to place, direction and scale of the world before. Px are those of what is matched (2
/// MP at most).
struct PoseRefinement {
  struct Errors {
    double medianPx = 0, p90Px = 0;  // of reprojections, points placed where they fit best
  };
  struct Moved {
    std::string photograph;
    double turnPx = 0;       // rotation × focal length
    double shift = 0;        // of the position, world units
    double focalFactor = 1;  // of the focal lengths
  };
  struct Step {
    std::string by;  // what more it goes by, or changes
    double cellsSurer = 0,
           modelSurer = 0;  // standard errors by which points of the other half fit better; NaN: too few
    bool taken = false;
  };
  std::size_t tracksOfCells = 0, tracksOfModel = 0;
  std::vector<Step> steps;  // tried one after the other, each against what was taken before
  Errors before, after;
  std::vector<Moved> moved;  // photographs that share a track; none where no step was taken: all poses are kept
};

}  // namespace ibr
