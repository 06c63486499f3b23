// SPDX-License-Identifier: Apache-2.0
// A synthetic walk around a court: any number of exact photographs with known poses and tracks.
#pragma once

#include <cstdint>
#include <vector>

#include "lab/generate/synthetic.h"

namespace ibr {

/// Four walls with boards before them, and a floor; the walk follows the walls and looks at them. The court grows with
/// the number of photographs, so that the distance between neighbours stays the same.
struct Court {
  std::vector<TexturedPlane> planes;
  std::vector<Camera> cameras;  // y up
};

/// `photographs`: 2 or more. Deterministic for a seed.
Court makeCourt(int photographs, int width, int height, std::uint64_t seed);

/// A pose on the way between photographs: `at` from 0 to 1 goes around once.
Camera cameraInCourt(const Court& court, double at);

/// Renders a camera's photograph, as renderTruth does. Planes that the camera cannot see cost next to nothing.
Image8 photograph(const Court& court, const Camera& camera, int samplesPerAxis = 2);

/// A point and the cameras that see it.
struct CourtTrack {
  glm::dvec3 position;
  struct Observation {
    std::uint32_t camera;
    glm::dvec2 pixel;
  };
  std::vector<Observation> seen;  // by camera, 2 or more
};

/// Visible points, spread over each camera's image; pixels are exact.
std::vector<CourtTrack> tracksOf(const Court& court, std::uint64_t seed);

}  // namespace ibr
