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
  /// Reprojection errors, after each point is triangulated again.
  struct Errors {
    double medianPx = 0, p90Px = 0;  // medianPx: median; p90Px: 90th percentile
  };
  /// Change of a photograph's camera.
  struct PoseChange {
    std::string photograph;  // name of the photograph
    double rotationPx = 0;   // angle of rotation × focal length, px
    double shift = 0;        // distance between the positions, world units
    double focalFactor = 1;  // new focal length over the old one
  };
  /// A step of the bundle adjustment.
  struct Step {
    std::string description;  // constraints or parameters that this step adds, for people
    // Gain in standard errors, NaN for too few points. cellsGainSigmas: better fit of held-out points of the cells;
    // modelGainSigmas: better fit of held-out points of the model
    double cellsGainSigmas = 0, modelGainSigmas = 0;
    bool accepted = false;  // true: neither gain is below 3, and not both are NaN
  };
  // Number of tracks. cellTracks: of the cells; modelTracks: of the model
  std::size_t cellTracks = 0, modelTracks = 0;
  std::vector<Step> steps;            // steps in order; each is compared with the last step accepted
  Errors initialErrors, finalErrors;  // initialErrors: with the given poses; finalErrors: with the refined ones
  // One for each photograph that shares a track; empty if no step was accepted: poses are unchanged.
  std::vector<PoseChange> poseChanges;
};

}  // namespace ibr
