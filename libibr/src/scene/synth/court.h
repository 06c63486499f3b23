// SPDX-License-Identifier: Apache-2.0
// A walk around a court, photographed exactly: any number of photographs whose poses and tracks are known.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/synth/synthetic.h"

namespace ibr {

/// Four walls with boards before them, a floor; the walk goes around along the walls and looks at them. The court grows
/// with the number of photographs, so that any two neighbours are as far from each other.
struct Court {
  std::vector<TexturedPlane> planes;
  std::vector<Camera> cameras;  // y up
};

/// `photographs`: 2 or more. The same seed makes the same court.
Court makeCourt(int photographs, int width, int height, std::uint64_t seed);

/// A pose on the way between photographs: `at` from 0 to 1 goes around once.
Camera cameraInCourt(const Court& court, double at);

/// What a camera sees of it, as renderTruth has it. Planes that it cannot see cost next to nothing.
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

/// Points that cameras see, spread over each one's picture; pixels are exact.
std::vector<CourtTrack> tracksOf(const Court& court, std::uint64_t seed);

}  // namespace ibr
