// SPDX-License-Identifier: Apache-2.0
// Backdrop of a photograph: its depth map as a mesh of one member, which votes for the depth of gathered views
// (Composition::gathered).
//
//   1. completes the depth (complete_depth.h)
//   2. places vertices by quadtree where parallax is not linear; more along the image border and in its corners, so
//      that the Delaunay triangles fill the image exactly
//   3. splits triangles that stretch across an edge of known depth: both surfaces continue to the jump. Drops such
//      triangles where depth was completed, since another photograph may show the background
#pragma once

#include "author/mesh/mesh.h"
#include "ibr/camera.h"
#include "ibr/image.h"

namespace ibr {

struct BackdropOptions {
  double step = 0;  // typical distance of a virtual camera from the photograph, world units, >= 0
  double cut = 0;   // baseline, world units, at which triangles of too large parallax change are cut; 0: step
  int spacing = 8;  // min distance of vertices, px of the depth map; a power of two, 2 to 32
};

/// Longest side of a backdrop's depth map, px. DepthSearch::fine uses up to twice this.
inline constexpr int kBackdropSide = 512;
inline constexpr int kPanoramaSide = 2048;  // of a panorama's depth map, px

/// Size of the depth map of a photograph, at most the photograph's own.
glm::ivec2 backdropSize(const Intrinsics& stored);

/// `stored`: the photograph's camera at its stored size. `inverseDepth`: along its axis (panoramas: along the ray), at
/// backdropSize or finer, kUnknownDepth where unknown. `colours`: RGB, the same size. Matches are in px of the stored
/// photograph. quality.coverage is the share of the image whose depth was known.
CellMesh buildBackdrop(const Camera& stored, const ImageF& inverseDepth, const Image8& colours,
                       const BackdropOptions& options);

/// The same, with depth that completeDepth has completed already, of the same size.
CellMesh buildBackdrop(const Camera& stored, const ImageF& inverseDepth, const ImageF& completed,
                       const BackdropOptions& options);

}  // namespace ibr
