// SPDX-License-Identifier: Apache-2.0
// From a dense match to a morphing mesh ([T] §2.4.1).
//
//   1. vertices by quadtree, their depths refined; Delaunay on their positions in the mean frame
//   2. repair: while triangles fold over in some member, drop the vertex of each that most of them share; those between
//      two surfaces fold over by right and are left to step 4
//   3. label each triangle by how well the members agree in it; what folds over or disagrees becomes tier 1
//   4. layers: what was rejected because it spans a depth edge is cut there (layers.h), its pieces labelled likewise
//   5. ρ, its uncertainty and a_i of every vertex
// Positions stand on a grid (orientation.h): no triangle of tier 0 folds over in a member or the mean frame.
#pragma once

#include <span>

#include "author/match/match.h"
#include "ibr/scene.h"

namespace ibr {

struct CellMesh {
  MorphMesh mesh;  // matches in px of the stored photographs
  CellQuality quality;
};

/// `stored` are the members' cameras at the size of the stored photographs; the views may be smaller versions of them,
/// at poses adjusted for matching: ρ and a_i belong to the poses of `stored`. `filter`: what a triangle of tier 0 needs
/// beyond looking alike and consistency.
CellMesh buildMesh(std::span<const Camera> stored, std::span<const MatchView> views, const DenseMatch& match,
                   TriangleFilter filter = TriangleFilter::consistency);

}  // namespace ibr
