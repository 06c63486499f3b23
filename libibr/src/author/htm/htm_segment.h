// SPDX-License-Identifier: Apache-2.0
// [H]'s "image segment (vertex)": the faces that share a vertex, as one camera sees them, to be coloured from another
// camera's image (I^v_{M_i←M_j}).
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/gtc/type_precision.hpp>
#include <span>
#include <vector>

#include "author/htm/htm_adjacency.h"
#include "author/htm/htm_views.h"
#include "ibr/template_search.h"

namespace ibr {

struct SegmentOptions {
  double minRadiusPx = 8;   // px; if the vertex's faces are smaller, the faces around them are included
  double maxRadiusPx = 24;  // px from the vertex; pixels farther away are left out
};

using SegmentPixel = glm::i16vec2;  // column, row

/// Segments of all vertices in one projected mesh. Not thread-safe.
class Segments {
 public:
  /// The arguments must outlive the object. `faces`: facesAtVertices of the mesh.
  Segments(const TriangleMesh& mesh, const Lists& faces, const ProjectedMesh& view, const SegmentOptions& options);

  /// Sorted by rows; empty if the vertex is not in front of the camera. Valid until the next call. v must be a vertex.
  const std::vector<SegmentPixel>& of(std::size_t v);

 private:
  void markRings(std::size_t v, glm::dvec2 middle);

  const TriangleMesh& mesh_;
  const Lists& faces_;
  const ProjectedMesh& view_;
  SegmentOptions options_;
  std::vector<std::uint32_t> mark_;  // of faces: the last call that marked the face
  std::uint32_t call_ = 0;
  double radius_ = 0;
  std::vector<std::uint32_t> ring_;
  std::vector<SegmentPixel> pixels_;
};

/// Segments in a view of the vertices that have `camera` as a member; empty for other vertices.
std::vector<std::vector<SegmentPixel>> segmentsOf(const TriangleMesh& mesh, const Lists& faces,
                                                  const ProjectedMesh& view, const SegmentOptions& options,
                                                  std::span<const CameraSet> members, std::size_t camera);

/// One view in another view's colours. Each pixel is computed on first use, since neighbouring segments share most of
/// their pixels. Not thread-safe; the views must outlive the object.
class Recoloured {
  struct Colour {
    std::uint8_t red, green, blue;
    enum State : std::uint8_t { unknown, hidden, seen } state;
  };

 public:
  static constexpr std::size_t kBytesPerPixel = sizeof(Colour);  // memory per pixel of the view

  Recoloured(const ProjectedMesh& view, const ProjectedMesh& from);

  /// Returns the segment's pixels whose point is visible in `from`, with the colours of `from`, rounded.
  std::vector<TemplateSample> of(std::span<const SegmentPixel> segment);

 private:
  Colour colourAt(SegmentPixel pixel) const;

  const ProjectedMesh &view_, &from_;
  std::vector<Colour> colours_;
};

}  // namespace ibr
