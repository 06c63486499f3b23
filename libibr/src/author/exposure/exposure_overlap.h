// SPDX-License-Identifier: Apache-2.0
// Where the fields of view of two photographs overlap, whether or not a cell joins them.
//
// Two photographs from one spot that look elsewhere (the faces of a split panorama, a turn of the head) share a strip
// along their borders. No cell joins them, since nothing can be ranged there, and few tracks do; but a rotation alone
// says where one shows what the other shows. That holds as long as the parallax stays below a small window's size:
// beyond that the depth that cells matched is asked, in both.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "author/jobs/build_jobs.h"
#include "author/photographs/photographs.h"
#include "ibr/author.h"
#include "ibr/scene.h"

namespace ibr {

/// What two photographs show of one place.
struct OverlapPoint {
  std::uint32_t first = 0, second = 0;  // photographs, first < second
  glm::dvec3 ray{0};                    // unit, from the first
  double inverseDistance = 0;           // from the first along it, per unit of the world; 0: at infinity
};

/// At most 1200 points (fewer of more than 72 photographs) for each two photographs that no cell joins, each with its 8
/// nearest such neighbours, and those with it. `model`: of these photographs, `scene`: its nodes are these, with the
/// cells that there are. Throws Error{cancelled}.
std::vector<OverlapPoint> overlapPoints(const std::vector<Photograph>& photographs, const PosedModel& model,
                                        const Scene& scene, const BuildJobs& jobs);

}  // namespace ibr
