// SPDX-License-Identifier: Apache-2.0
// Uncertainty of a vertex's ρ. Triangulation only knows the noise of one match. Depth from a sweep can also be wrong by
// whole surfaces, where neighbours disagree.
//
//   σ² = σ_triangulation² + (mean |ρ − ρ_neighbour|)² + (1.1 levels of the sweep)²
#pragma once

#include <span>

#include "ibr/scene.h"

namespace ibr {

inline constexpr double kUncertaintyLevels = 1.1;  // fitted to exact depth, as the weights of 1 of the other terms

/// Enlarges mesh.uncertainty, which is σ_triangulation on entry. `level`: for each vertex, one level of the sweep as a
/// change of ρ. Neighbours share an edge of any triangle.
void widenUncertainty(MorphMesh& mesh, std::span<const double> level);

}  // namespace ibr
