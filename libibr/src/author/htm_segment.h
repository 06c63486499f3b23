// SPDX-License-Identifier: Apache-2.0
// [H]'s "image segment (vertex)": the faces that share a vertex, as one camera sees them, ready to be coloured from
// another one's picture (I^v_{M_i←M_j}).
#pragma once

#include <cstdint>
#include <vector>

#include "author/htm_adjacency.h"
#include "author/htm_views.h"
#include "ibr/template_search.h"

namespace ibr {

struct SegmentOptions {
  double leastRadius = 8;  // px; where the faces at a vertex are smaller, those around them belong to it too
  double mostRadius = 24;  // px from the vertex; what lies further away is left out
};

struct SegmentPixel {
  glm::ivec2 pixel;
  glm::dvec3 point;  // of the mesh, that the pixel's centre shows
};

/// Segments of all vertices in one projected mesh. For one thread.
class Segments {
 public:
  /// The arguments are read until the object goes. `faces`: facesAtVertices of the mesh.
  Segments(const TriangleMesh& mesh, const Lists& faces, const ProjectedMesh& view, const SegmentOptions& options);

  /// By rows; empty where the vertex is not before the camera. Precondition: v is a vertex. Good until the next call.
  const std::vector<SegmentPixel>& of(std::size_t v);

 private:
  void markRings(std::size_t v, glm::dvec2 middle);

  const TriangleMesh& mesh_;
  const Lists& faces_;
  const ProjectedMesh& view_;
  SegmentOptions options_;
  std::vector<std::uint32_t> mark_;  // of faces: the call that they belong to
  std::uint32_t call_ = 0;
  double radius_ = 0;
  std::vector<std::uint32_t> ring_;
  std::vector<SegmentPixel> pixels_;
};

/// The segment with another camera's colours: pixels whose point that camera sees. A Template's colours are rounded.
std::vector<TemplateSample> coloured(const std::vector<SegmentPixel>& segment, const ProjectedMesh& from);

}  // namespace ibr
