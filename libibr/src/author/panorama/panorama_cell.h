// SPDX-License-Identifier: Apache-2.0
// Morphing cells of panoramas ([T] §2.4.1 on the sphere): matched on pinhole faces, triangulated on the sphere.
//
//   1. a cube around the mean of the members' centres; each member resampled to its six faces, all faces parallel
//   2. each face matched like pinhole photographs; vertices within the face's own 90° are kept
//   3. Delaunay triangulation of the directions from the mean centre, on the sphere (CGAL)
//   4. repair and labels as in the plane; a triangle is evaluated in the face of its centre
#pragma once

#include <span>
#include <vector>

#include "author/match/match.h"
#include "author/mesh/mesh.h"

namespace ibr {

struct PanoramaView {
  Camera camera;   // equirectangular, at the stored size
  Image8 picture;  // RGB, of any size with the same shape
  Image8 mask;     // of the picture's size, 0 where ignored; empty: no mask
};

/// Side of a face on which cells of panoramas of this width are matched, px; there are six faces.
int matchedFaceSide(int panoramaWidth);

/// Matches the panoramas face by face and returns the labelled mesh of the cell between them. `points`: world points
/// that the members see, which bound the depths; without any, surfaces nearer than half of the members' distance are
/// not found. Coverage is the share of the sphere. Precondition: 2 to 4 views at different positions. Throws Error.
CellMesh makePanoramaCell(std::span<const PanoramaView> views, std::span<const glm::dvec3> points,
                          const MatchOptions& options = {});

}  // namespace ibr
