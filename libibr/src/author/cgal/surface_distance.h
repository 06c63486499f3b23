// SPDX-License-Identifier: Apache-2.0
// Distance of one surface from another (Cignoni, Rocchini, Scopigno, Metro, 1998).
#pragma once

#include <cstdint>

#include "ibr/htm_model.h"

namespace ibr {

struct SurfaceDistance {
  double mean = 0, p95 = 0, max = 0;  // in the meshes' unit, over the samples
  std::size_t samples = 0;
};

/// Distances from samples of one mesh, uniform over its area and determined by the seed, to the nearest point of the
/// other. Precondition: both meshes have a face with an area.
SurfaceDistance surfaceDistance(const TriangleMesh& from, const TriangleMesh& to, std::size_t samples = 20000,
                                std::uint64_t seed = 1);

}  // namespace ibr
