// SPDX-License-Identifier: Apache-2.0
// Poses and focal lengths that agree better, by what matching says about all photographs. Needs ibr::author.
#pragma once

#include <string>
#include <vector>

#include "ibr/author.h"

namespace ibr {

/// How poses changed when they were refined: by bundle adjustment over the model's tracks and the matches of all cells,
/// as far as points that it was not made with confirm it, brought back to place, direction and scale of the world
/// before. Px are those of what is matched (2 MP at most).
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
    std::string by;                         // what more it goes by, or changes
    double cellsSurer = 0, modelSurer = 0;  // standard errors by which points of the other half fit better; NaN: too few
    bool taken = false;
  };
  std::size_t tracksOfCells = 0, tracksOfModel = 0;
  std::vector<Step> steps;  // tried one after the other, each against what was taken before
  Errors before, after;
  std::vector<Moved> moved;  // photographs that share a track; none where no step was taken: all poses are kept
};

struct RefinedModel {
  PosedModel model;           // with the tracks that the build had, our own included
  PoseRefinement refinement;  // no photograph moved: poses are kept; the model is as it was
};

/// Matches the cells of a build with these options and refines poses by them, where they are estimates: where the
/// model's points reproject exactly, all stays, and where refined poses do not suit points better that they were not
/// refined by. For builds that are to have them: write the model and name it. Of the output only the finished cells are
/// written, or `finishedCells`. Throws Error as build.
RefinedModel refinedModel(const BuildOptions& options, const ProgressCallback& progress = {},
                          const LogCallback& log = {});

}  // namespace ibr
