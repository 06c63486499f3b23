// SPDX-License-Identifier: Apache-2.0
// Parallax as layers: a triangle across a depth edge is no surface. Cutting it along the edge gives the surfaces in
// front and behind a triangle each.
//
//   a triangle's corners are split into near and far at the largest gap of their depths
//   each of the two edges between near and far corners is cut at the silhouette (silhouette.h); a cut is two vertices
//   at one position of the frame, one on the near surface, one on the far; adjacent triangles share them. The near side
//   ends at the cut, at near depth. The far side starts at the cut, at far depth, and continues behind the near side up
//   to its corners, at the depth of the far corners' planes
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "author/mesh/silhouette.h"

namespace ibr {

/// A vertex that a cut adds.
struct LayerVertex {
  SurfaceSample place;
  unsigned surfaceVertex;  // the mesh's vertex whose surface this one continues
};

/// Pieces that replace one triangle of the mesh.
struct LayerSplit {
  std::size_t triangle;
  std::vector<glm::uvec3> surface;  // cover the triangle in the frame without overlap
  std::vector<glm::uvec3> behind;   // far side that is hidden in the frame
};

struct Layers {
  std::vector<LayerVertex> vertices;  // numbered from the mesh's vertex count
  std::vector<LayerSplit> splits;     // by triangle, ascending
};

/// Cuts those `triangles` for which `wanted` is true and a silhouette is found. `frame` and `inverseDepth` are the
/// mesh's vertices. Deterministic; pieces keep their triangle's orientation in the frame.
Layers cutAtSilhouettes(const SilhouetteFinder& finder, std::span<const glm::vec2> frame,
                        std::span<const double> inverseDepth, std::span<const glm::uvec3> triangles,
                        const std::vector<bool>& wanted);

}  // namespace ibr
