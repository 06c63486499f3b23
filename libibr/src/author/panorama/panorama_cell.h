// SPDX-License-Identifier: Apache-2.0
// Morphing cells of panoramas ([T] §2.4.1 on the sphere): matched on pinhole faces, triangulated on the sphere.
//
//   1. a cube about the mean of the members' centres; each member resampled to its six faces, all faces parallel
//   2. each face matched as pinhole photographs are; kept are the vertices within the face's own quarter of the view
//   3. Delaunay triangulation of their directions from the mean centre, on the sphere (CGAL)
//   4. repair and labels as in the plane; a triangle is looked at in the face that its middle lies in
#pragma once

#include <span>
#include <vector>

#include "author/match/match.h"
#include "author/mesh/mesh.h"

namespace ibr {

struct PanoramaView {
  Camera camera;   // equirectangular, at the stored size
  Image8 picture;  // RGB, of any size with the same shape
  Image8 mask;     // of the picture's size, 0 where it is ignored; empty: nothing is
};

/// `points` of the world that the members see bound the depths; where there are none, what is nearer than half of the
/// members' distance is not found. Coverage is the share of the sphere. Precondition: 2 to 4 views at different
/// places. Throws Error.
CellMesh panoramaCell(std::span<const PanoramaView> views, std::span<const glm::dvec3> points,
                      const MatchOptions& options = {});

}  // namespace ibr
