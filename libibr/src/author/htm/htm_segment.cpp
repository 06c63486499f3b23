// SPDX-License-Identifier: Apache-2.0
#include "author/htm/htm_segment.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/bilinear.h"

namespace ibr {

Segments::Segments(const TriangleMesh& mesh, const Lists& faces, const ProjectedMesh& view,
                   const SegmentOptions& options)
    : mesh_(mesh), faces_(faces), view_(view), options_(options), mark_(mesh.triangles.size(), 0) {}

// Marks the faces at v, and rings of faces around them until they reach minRadiusPx.
void Segments::markRings(std::size_t v, glm::dvec2 middle) {
  constexpr int kMaxRings = 6;
  ++call_;
  ring_.assign(1, std::uint32_t(v));
  radius_ = 0;
  std::size_t first = 0;
  for (int ring = 0; ring < kMaxRings; ++ring) {
    const std::size_t end = ring_.size();
    double nearest = options_.maxRadiusPx;  // radius of the rim that this ring adds
    for (std::size_t k = first; k < end; ++k)
      for (const std::uint32_t face : faces_[ring_[k]]) {
        if (mark_[face] == call_) continue;
        mark_[face] = call_;
        for (int corner = 0; corner < 3; ++corner) {
          const std::uint32_t u = mesh_.triangles[face][corner];
          const auto seen = view_.view.seen(mesh_.positions[u]);
          if (!seen) continue;
          const double distance = glm::distance(seen->pixel, middle);
          radius_ = std::max(radius_, distance);
          if (std::ranges::find(ring_, u) == ring_.end()) {
            ring_.push_back(u);
            nearest = std::min(nearest, distance);
          }
        }
      }
    if (nearest >= options_.minRadiusPx || ring_.size() == end) break;
    first = end;
  }
  radius_ = std::min(radius_, options_.maxRadiusPx);
}

const std::vector<SegmentPixel>& Segments::of(std::size_t v) {
  pixels_.clear();
  const auto seen = view_.view.seen(mesh_.positions[v]);
  if (!seen || std::abs(seen->pixel.x) > 1e6 || std::abs(seen->pixel.y) > 1e6) return pixels_;
  const glm::dvec2 middle = seen->pixel;
  markRings(v, middle);
  const Image<std::uint32_t>& shown = view_.raster.face;
  const int left = std::max(0, int(std::floor(middle.x - radius_))),
            top = std::max(0, int(std::floor(middle.y - radius_)));
  const int right = std::min(shown.width - 1, int(std::ceil(middle.x + radius_)));
  const int bottom = std::min(shown.height - 1, int(std::ceil(middle.y + radius_)));
  for (int y = top; y <= bottom; ++y)
    for (int x = left; x <= right; ++x) {
      const std::uint32_t face = shown.pixel(x, y)[0];
      const glm::dvec2 centre(x + 0.5, y + 0.5);
      if (face == MeshRaster::kNone || mark_[face] != call_ || glm::distance(centre, middle) > options_.maxRadiusPx)
        continue;
      pixels_.emplace_back(x, y);
    }
  return pixels_;
}

std::vector<std::vector<SegmentPixel>> segmentsOf(const TriangleMesh& mesh, const Lists& faces,
                                                  const ProjectedMesh& view, const SegmentOptions& options,
                                                  std::span<const CameraSet> members, std::size_t camera) {
  Segments segments(mesh, faces, view, options);
  std::vector<std::vector<SegmentPixel>> all(members.size());
  for (std::size_t v = 0; v < all.size(); ++v)
    if (members[v] >> camera & 1) all[v] = segments.of(v);
  return all;
}

Recoloured::Recoloured(const ProjectedMesh& view, const ProjectedMesh& from)
    : view_(view), from_(from), colours_(view.raster.depth.values.size(), Colour{0, 0, 0, Colour::unknown}) {}

Recoloured::Colour Recoloured::colourAt(SegmentPixel pixel) const {
  const double depth = view_.raster.depth.pixel(pixel.x, pixel.y)[0];
  const auto at = from_.visible(view_.view.point(glm::dvec2(pixel) + 0.5, depth));
  if (!at) return {0, 0, 0, Colour::hidden};
  const glm::dvec3 colour = bilinear(*from_.picture, *at) + 0.5;
  return {std::uint8_t(colour.x), std::uint8_t(colour.y), std::uint8_t(colour.z), Colour::seen};
}

std::vector<TemplateSample> Recoloured::of(std::span<const SegmentPixel> segment) {
  std::vector<TemplateSample> samples;
  samples.reserve(segment.size());
  for (const SegmentPixel pixel : segment) {
    Colour& colour = colours_[std::size_t(pixel.y) * std::size_t(view_.raster.depth.width) + std::size_t(pixel.x)];
    if (colour.state == Colour::unknown) colour = colourAt(pixel);
    if (colour.state == Colour::seen) samples.push_back({pixel.x, pixel.y, colour.red, colour.green, colour.blue});
  }
  return samples;
}

}  // namespace ibr
