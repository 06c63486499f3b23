// SPDX-License-Identifier: Apache-2.0
// Whether places stand on a rectangular grid, noise allowed, and simplices that split such a grid consistently.
//
//   1. edges of the shortest spanning tree run along the axes of a grid, whatever its steps: their directions fall
//      into at most three, at right angles to each other
//   2. along each axis the places fall into levels; the steps between levels may differ
//   3. no two places have the same levels, and most combinations of levels are there
//   4. the simplices are Delaunay's for the levels laid out on steps at obtuse angles (Selling's reduced bases; A* is
//      the regular one): a whole square or cube is split as Kuhn splits it, into 2 triangles or 6 tetrahedra along one
//      diagonal that is the same everywhere, and faces of neighbours agree; where places are missing, what Delaunay
//      finds stands in
//
// So the split of a place's surroundings depends on no noise, and is the same for all photographs of each place.
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
  std::vector<std::array<int, 3>> levels;  // of each place along each axis, from 0; 0 beyond the rank
};

/// nullopt where they stand on none. Directions of the axes are such that the first place that is not in the middle has
/// the lower level: neither the world's position, rotation nor scale change the result.
std::optional<Lattice> findLattice(std::span<const glm::dvec3> places);

/// Simplices of some of a lattice's places as indices into `chosen` (which holds indices into lattice.levels), of the
/// rank that those span; each ascending, all sorted.
std::vector<Simplex> splitLattice(const Lattice& lattice, std::span<const std::uint32_t> chosen);

/// How many axes a simplex of the lattice's places extends along.
int extent(const Lattice& lattice, std::span<const std::uint32_t> places);

}  // namespace ibr
