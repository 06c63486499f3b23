// SPDX-License-Identifier: Apache-2.0
// How far a vertex's ρ may be off: what triangulation knows is only the noise of one match. Depth from a sweep errs by
// whole surfaces too, and there neighbours disagree.
//
//   σ² = σ_triangulation² + (mean |ρ − ρ_neighbour|)² + (1.1 levels of the sweep)²
#pragma once

#include <span>

#include "ibr/scene.h"

namespace ibr {

inline constexpr double kUncertaintyLevels = 1.1;  // fitted to exact depth, as the other two weights of 1 were

/// Enlarges mesh.uncertainty, which is σ_triangulation on entry. `level`: of each vertex, one level of the sweep as a
/// change of ρ. Neighbours are those by an edge of any triangle.
void widenUncertainty(MorphMesh& mesh, std::span<const double> level);

}  // namespace ibr
