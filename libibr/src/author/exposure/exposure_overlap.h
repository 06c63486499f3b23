// SPDX-License-Identifier: Apache-2.0
// What two photographs show of the same places.
//
// Where the depth of a photograph is confirmed, it says where another one shows the place, and that one's depth says
// whether it does. Two photographs from one spot that look elsewhere (the faces of a split panorama, a turn of the
// head) share a strip along their borders whose depth nobody may know; there a rotation alone says where one shows what
// the other shows, as long as the parallax stays below a small window's size.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "author/depth/photograph_depth.h"
#include "author/geometry/posed_model.h"
#include "author/jobs/build_jobs.h"
#include "author/photographs/photographs.h"

namespace ibr {

/// What two photographs show of one place.
struct OverlapPoint {
  std::uint32_t first = 0, second = 0;  // photographs, first < second
  glm::dvec3 ray{0};                    // unit, from the first
  double inverseDistance = 0;           // from the first along it, per unit of the world; 0: at infinity
};

/// About how many points there are of so many photographs, at most.
std::size_t mostOverlapPoints(std::size_t photographs);

/// At most 1200 points (fewer of more than 29 photographs) for each two photographs, each with its 20 nearest
/// neighbours that share enough with it, and those with it. `model` and `depths`: of these photographs, in their order.
/// Throws Error{cancelled}.
std::vector<OverlapPoint> overlapPoints(const std::vector<Photograph>& photographs, const PosedModel& model,
                                        const std::vector<PhotographDepth>& depths, const BuildJobs& jobs);

}  // namespace ibr
