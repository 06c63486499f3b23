// SPDX-License-Identifier: Apache-2.0
// A shape that agrees better: what matches say about how far each vertex is from the surface, all of them together.
//
// [H] leaves the shape as it is and deforms textures alone. A vertex that is off along its normal displaces each pair's
// match along the pair's epipolar line; one number a vertex explains them all, which errs far less than each by itself.
#pragma once

#include <span>
#include <vector>

#include "author/htm/htm_match.h"

namespace ibr {

struct ShapeOptions {
  double smoothness = 1;  // 1 / px²: inverse variance of the displacement's difference between neighbours, in the
                          // pixels that it moves the vertex by between two cameras (root mean square over its pairs)
  double outlierPx = 2;   // a match further off than this loses its weight (Geman and McClure 1987)
  int threads = 0;        // for outlines; 0: all cores
};

/// How far each vertex moves along its outward normal, world units; 0 where nothing was matched around. Cameras look at
/// the vertex by more than 15 degrees from its tangent plane, else they do not count. Vertices on the mesh's outline in
/// a view with a mask are drawn to the mask's border as well, if that is within 12 px; in a view without one they stay.
/// `progress` reports views and sweeps; throws Error{cancelled}.
std::vector<double> normalDisplacements(const TriangleMesh& mesh, std::span<const HtmView> views,
                                        std::span<const CameraSet> members, std::span<const VertexMatch> matches,
                                        const ShapeOptions& options, const ProgressCallback& progress = {});

/// The mesh with its vertices moved along their normals; where that would turn a face's normal by more than 60 degrees
/// its vertices stay.
TriangleMesh displaced(const TriangleMesh& mesh, std::span<const double> displacements);

/// Unit, area-weighted; 0 for a vertex without faces.
std::vector<glm::dvec3> vertexNormals(const TriangleMesh& mesh);

}  // namespace ibr
