// SPDX-License-Identifier: Apache-2.0
// Report of a pose refinement.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace ibr {

/// Result of a bundle adjustment over the model's tracks and the matches of all cells. Each step is accepted only if
/// points held out from it fit better. Position, orientation and scale of the world are restored afterwards. Px refer
/// to the matched images: photographs scaled down to at most 2 megapixels.
struct PoseRefinement {
  struct Errors {
    double medianPx = 0, p90Px = 0;  // of reprojections, after each point is triangulated again
  };
  struct PoseChange {
    std::string photograph;
    double rotationPx = 0;   // angle of rotation × focal length
    double shift = 0;        // of the position, world units
    double focalFactor = 1;  // new focal length over the old one
  };
  struct Step {
    std::string description;  // constraints or parameters that this step adds, for people
    // Better fit of held-out points of the cells and of the model, in standard errors; NaN: too few points.
    double cellsGainSigmas = 0, modelGainSigmas = 0;
    bool accepted = false;  // neither value is below 3, and not both are NaN
  };
  std::size_t cellTracks = 0, modelTracks = 0;
  std::vector<Step> steps;  // in order; each is compared with the last step accepted
  Errors initialErrors, finalErrors;
  // One for each photograph that shares a track; empty if no step was accepted: poses are unchanged.
  std::vector<PoseChange> poseChanges;
};

}  // namespace ibr
