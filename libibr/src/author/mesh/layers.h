// SPDX-License-Identifier: Apache-2.0
// Parallax as layers: a triangle across a depth edge is no surface; it is cut along the edge, so that what is before it
// and what is behind it both have one.
//
//   corners of a triangle part into near and far at the largest gap of their depths
//   each of its two edges between the parts is cut at the silhouette (silhouette.h); the cut is two vertices at one
//   place of the frame, one on the near surface, one on the far; triangles on both sides of an edge share them
//   near side: as far as the cut, near depth; far side: from the cut on, far depth, and also on behind the near side,
//   at most as far as its corners, at the depth that the far corners' planes have there
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "author/mesh/silhouette.h"

namespace ibr {

/// A vertex that a cut adds.
struct LayerVertex {
  SurfaceSample place;
  unsigned like;  // the vertex of the mesh whose surface it continues
};

/// What stands for one triangle of the mesh.
struct LayerSplit {
  std::size_t triangle;
  std::vector<glm::uvec3> surface;  // cover the triangle in the frame, each place once
  std::vector<glm::uvec3> behind;   // far side that the frame does not see
};

struct Layers {
  std::vector<LayerVertex> vertices;  // numbered from the mesh's vertex count
  std::vector<LayerSplit> splits;     // by triangle, ascending
};

/// Cuts those `triangles` for which `wanted` is true and a silhouette is found. `frame` and `inverseDepth` are the
/// mesh's vertices. Deterministic; pieces turn as their triangle does in the frame.
Layers cutAtSilhouettes(const SilhouetteFinder& finder, std::span<const glm::vec2> frame,
                        std::span<const double> inverseDepth, std::span<const glm::uvec3> triangles,
                        const std::vector<bool>& wanted);

}  // namespace ibr
