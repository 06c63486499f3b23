// SPDX-License-Identifier: Apache-2.0
// Detects capture sites on a rectangular grid (up to noise), and splits such a grid consistently into simplices.
//
//   1. the edges of the minimum spanning tree run along the axes of a grid, whatever its steps: they have at most three
//      directions, at right angles to each other
//   2. along each axis the positions form levels; the steps between levels may differ
//   3. no two positions have the same levels, and most combinations of levels exist
//   4. simplices: Delaunay on the levels, laid out with steps at obtuse angles (Selling's reduced bases; A* is the
//      regular one). A whole square or cube is split as by Kuhn, into 2 triangles or 6 tetrahedra along one diagonal
//      that is the same everywhere, so faces of neighbours agree. Gaps of missing positions are filled by Delaunay
//
// The split is independent of noise, and the same for all photographs of each capture site.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "author/geometry/simplex.h"

namespace ibr {

struct Lattice {
  int rank = 0;                            // axes, 1 to 3
  std::vector<std::array<int, 3>> levels;  // of each position along each axis, from 0; 0 beyond the rank
};

/// Returns nullopt without a grid. The first position off the middle has the lower level on each axis: the world's
/// origin, rotation and scale do not change the result.
std::optional<Lattice> findLattice(std::span<const glm::dvec3> positions);

/// Simplices of the lattice's positions `chosen` (indices into lattice.levels), of the rank that they span. Returns
/// indices into `chosen`; each simplex ascending, all sorted.
std::vector<Simplex> splitLattice(const Lattice& lattice, std::span<const std::uint32_t> chosen);

/// Number of axes along which a simplex of the lattice's positions extends.
int extent(const Lattice& lattice, std::span<const std::uint32_t> positions);

}  // namespace ibr
