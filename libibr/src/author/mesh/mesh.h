// SPDX-License-Identifier: Apache-2.0
// Builds a morphing mesh from a dense match ([T] §2.4.1).
//
//   1. vertices by quadtree, depths refined; Delaunay on their positions in the mean frame
//   2. repair: while triangles fold over in some member, drop the vertex of each that most of them share; triangles
//      between two surfaces fold over legitimately and are left to step 4
//   3. label each triangle by the members' agreement; folded or disagreeing triangles become tier 1
//   4. layers: rejected triangles across a depth edge are cut at the edge (layers.h), and their pieces labelled
//   5. ρ, its uncertainty and a_i of every vertex
// Positions lie on a grid (orientation.h): no triangle of tier 0 folds over in a member or the mean frame.
#pragma once

#include <span>

#include "author/match/match.h"
#include "ibr/author/build.h"
#include "ibr/scene.h"

namespace ibr {

struct CellMesh {
  MorphMesh mesh;  // matches in px of the stored photographs
  CellQuality quality;
};

/// `stored`: the members' cameras at the size of the stored photographs. The views may be smaller, at poses adjusted
/// for matching: ρ and a_i belong to the poses of `stored`. `filter`: requirement for triangles of tier 0, beyond
/// similarity and consistency.
CellMesh buildMesh(std::span<const Camera> stored, std::span<const MatchView> views, const DenseMatch& match,
                   TriangleFilter filter = TriangleFilter::consistency);

}  // namespace ibr
