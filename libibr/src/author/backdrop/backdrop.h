// SPDX-License-Identifier: Apache-2.0
// A photograph's backdrop: its depth as a mesh of one member, which votes for the depth of views
// (Composition::gathered).
//
//   1. depth completed (complete_depth.h)
//   2. vertices by quadtree, where parallax is not linear; more along the picture's border and in its corners, so that
//      the Delaunay triangles fill it exactly
//   3. triangles stretched across an edge of known depth are split: both surfaces go on to where it jumps. Where depth
//      was completed they are left out, since another photograph may see what is behind
#pragma once

#include "author/mesh/mesh.h"
#include "ibr/camera.h"
#include "ibr/image.h"

namespace ibr {

struct BackdropOptions {
  double step = 0;  // world units that a virtual camera is likely to be away from the photograph; >= 0
  double cut = 0;   // world units: triangles are cut whose parallax changes too much over this baseline; 0: step
  int spacing = 8;  // least between vertices, in px of the depth's picture; a power of two, 2 to 32
};

/// Longest side of the pictures that depths of backdrops are kept in, px, but for DepthSearch::fine.
inline constexpr int kBackdropSide = 512;
inline constexpr int kPanoramaSide = 2048;  // of a panorama's

/// The size of that picture for a photograph, at most its own.
glm::ivec2 backdropSize(const Intrinsics& stored);

/// `stored`: the photograph's camera at its stored size. `inverseDepth`: along its axis (of a panorama: along the ray),
/// of backdropSize or finer, kUnknownDepth where unknown; `colours`: RGB, the same size. Matches are in px of the
/// stored photograph. quality.coverage is the share of the picture whose depth was known.
CellMesh buildBackdrop(const Camera& stored, const ImageF& inverseDepth, const Image8& colours,
                       const BackdropOptions& options);

/// The same from depth that was completed before (completeDepth), of the same size.
CellMesh buildBackdrop(const Camera& stored, const ImageF& inverseDepth, const ImageF& completed,
                       const BackdropOptions& options);

}  // namespace ibr
