// SPDX-License-Identifier: Apache-2.0
// Finds points that two photographs both show, for comparing exposures.
//
// Confirmed depth of a photograph gives the pixel in the other photograph, whose own depth tests for occlusion. Two
// photographs from one position with different directions (e.g. faces of a split panorama) share only a strip at their
// borders, often without known depth. There a rotation alone maps one photograph to the other, as long as the parallax
// stays below a small window's size.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "author/depth/photograph_depth.h"
#include "author/geometry/posed_model.h"
#include "author/jobs/build_jobs.h"
#include "author/photographs/photographs.h"

namespace ibr {

/// A point that two photographs show.
struct OverlapPoint {
  std::uint32_t first = 0, second = 0;  // photographs, first < second
  glm::dvec3 ray{0};                    // unit, from the first, world axes
  double inverseDistance = 0;           // from the first along the ray, 1 / world unit; 0: at infinity
};

/// Approximate max number of points for this number of photographs.
std::size_t maxOverlapPoints(std::size_t photographs);

/// At most 1200 points per pair (fewer for more than 29 photographs). Pairs: each photograph with its 20 nearest
/// neighbours that share enough points. `model` and `depths`: of these photographs, in their order. Throws
/// Error{cancelled}.
std::vector<OverlapPoint> overlapPoints(const std::vector<Photograph>& photographs, const PosedModel& model,
                                        const std::vector<PhotographDepth>& depths, const BuildJobs& jobs);

}  // namespace ibr
