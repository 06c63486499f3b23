// SPDX-License-Identifier: Apache-2.0
// Adjusts the shape to the matches: solves for the displacements of all vertices along their normals together.
//
// [H] keeps the shape and deforms textures only. A vertex that is off along its normal displaces each pair's match
// along the pair's epipolar line. One number per vertex explains all these matches, with a smaller error than each.
#pragma once

#include <span>
#include <vector>

#include "author/htm/htm_match.h"

namespace ibr {

struct ShapeOptions {
  double smoothness = 1;  // 1 / px²: inverse variance of the difference between neighbours' displacements, measured in
                          // px that a vertex moves between two cameras (root mean square over its pairs)
  double outlierPx = 2;   // a match this far off has a quarter of its weight (Geman and McClure 1987)
  int threads = 0;        // for the outlines; 0: all cores
};

/// Returns each vertex's displacement along its outward normal, world units; 0 where nothing around was matched. A
/// camera counts only if it sees the vertex at more than 15 degrees from its tangent plane. Vertices on the mesh's
/// outline in a view are drawn to the mask's border within 12 px; in a view without a mask they are held. `progress`
/// reports views and sweeps; throws Error{cancelled}.
std::vector<double> normalDisplacements(const TriangleMesh& mesh, std::span<const HtmView> views,
                                        std::span<const CameraSet> members, std::span<const VertexMatch> matches,
                                        const ShapeOptions& options, const ProgressCallback& progress = {});

/// Returns the mesh with its vertices moved along their normals. Vertices of a face whose normal would turn by more
/// than 60 degrees are not moved.
TriangleMesh displaced(const TriangleMesh& mesh, std::span<const double> displacements);

/// Unit, area-weighted; 0 for a vertex without faces.
std::vector<glm::dvec3> vertexNormals(const TriangleMesh& mesh);

}  // namespace ibr
