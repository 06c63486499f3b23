// SPDX-License-Identifier: Apache-2.0
// [H]'s "image segment (vertex)": the faces that share a vertex, as one camera sees them, ready to be coloured from
// another one's picture (I^v_{M_i←M_j}).
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
  double leastRadius = 8;  // px; where the faces at a vertex are smaller, those around them belong to it too
  double mostRadius = 24;  // px from the vertex; what lies further away is left out
};

using SegmentPixel = glm::i16vec2;  // column, row

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

/// Segments in a view for those vertices that `camera` is a member of, empty for others.
std::vector<std::vector<SegmentPixel>> segmentsOf(const TriangleMesh& mesh, const Lists& faces,
                                                  const ProjectedMesh& view, const SegmentOptions& options,
                                                  std::span<const CameraSet> members, std::size_t camera);

/// One view in another one's colours, each pixel from when it is first asked for: segments of neighbours share most of
/// their pixels. For one thread; the views are read until it goes.
class Recoloured {
  struct Colour {
    std::uint8_t red, green, blue;
    enum State : std::uint8_t { unknown, hidden, seen } state;
  };

 public:
  static constexpr std::size_t kBytesAPixel = sizeof(Colour);  // of the view, that one of these takes

  Recoloured(const ProjectedMesh& view, const ProjectedMesh& from);

  /// The segment's pixels whose point `from` sees, with its colours, rounded.
  std::vector<TemplateSample> of(std::span<const SegmentPixel> segment);

 private:
  Colour colourAt(SegmentPixel pixel) const;

  const ProjectedMesh &view_, &from_;
  std::vector<Colour> colours_;
};

}  // namespace ibr
