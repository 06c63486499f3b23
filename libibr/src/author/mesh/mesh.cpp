// SPDX-License-Identifier: Apache-2.0
#include "author/mesh/mesh.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>

#include "author/cgal/delaunay.h"
#include "author/geometry/orientation.h"
#include "author/match/plane_labels.h"
#include "author/match/ranges.h"
#include "author/match/vertices.h"
#include "author/mesh/label.h"
#include "author/mesh/layers.h"
#include "author/mesh/uncertainty.h"

namespace ibr {
namespace {

struct Vertices : MatchedVertices {
  std::vector<std::vector<glm::vec2>> stored;  // for each member, px of its stored photograph, on the grid

  Vertices(std::span<const Camera> cameras, std::span<const MatchView> views, const DenseMatch& match)
      : MatchedVertices(matchedVertices(views, match)), stored(matched) {
    for (glm::vec2& at : frame) at = snapped(glm::dvec2(at));
    for (std::size_t i = 0; i < views.size(); ++i) {
      scale_.emplace_back(double(cameras[i].intrinsics.width) / double(views[i].picture.width),
                          double(cameras[i].intrinsics.height) / double(views[i].picture.height));
      for (glm::vec2& position : stored[i]) position = snapped(glm::dvec2(position) * scale_[i]);
    }
  }

  std::size_t count() const { return frame.size(); }
  std::vector<glm::uvec3> triangulate() const {
    return delaunayTriangles(std::vector<glm::dvec2>(frame.begin(), frame.end()));
  }
  bool folded(const glm::uvec3& t) const {
    constexpr auto kMinTwiceArea = std::int64_t(1e-3 * kGridPerPixel * kGridPerPixel);  // 1e-3 px²
    return twiceArea(frame, t) <= kMinTwiceArea ||
           std::ranges::any_of(stored, [&](const auto& positions) { return twiceArea(positions, t) <= kMinTwiceArea; });
  }
  void keepOnly(const std::vector<bool>& keep) {
    ibr::keepOnly(frame, keep);
    ibr::keepOnly(inverseDepth, keep);
    if (!planes.empty()) ibr::keepOnly(planes, keep);
    for (auto& list : matched) ibr::keepOnly(list, keep);
    for (auto& list : stored) ibr::keepOnly(list, keep);
  }

  // Vertices that continue a surface get the same deviation from the poses as that surface's matches.
  void add(const LayerVertex& vertex, std::span<const FrameToMember> maps) {
    for (std::size_t i = 0; i < maps.size(); ++i) {
      const auto here = maps[i](vertex.place.pixel, vertex.place.inverseDepth);
      const auto there = maps[i](glm::dvec2(frame[vertex.surfaceVertex]), inverseDepth[vertex.surfaceVertex]);
      const glm::dvec2 known(matched[i][vertex.surfaceVertex]);
      const glm::dvec2 put = here && there ? known + (*here - *there) : known;  // else it folds over and is removed
      matched[i].emplace_back(put);
      stored[i].push_back(snapped(put * scale_[i]));
    }
    frame.emplace_back(vertex.place.pixel);
    inverseDepth.push_back(vertex.place.inverseDepth);
    if (!planes.empty()) planes.push_back(planes[vertex.surfaceVertex]);
  }

 private:
  std::vector<glm::dvec2> scale_;
};

struct Face {
  glm::uvec3 corner;
  Tier tier;
  float ecc;
  bool inFrame;  // not hidden behind another one in the frame
};

// Replaces triangles across depth edges by layers. A piece that folds over in a member keeps the triangle unchanged.
void layer(std::span<const MatchView> views, const DenseMatch& match, Vertices& vertices,
           const std::vector<glm::uvec3>& triangles, std::vector<Face>& faces) {
  const SilhouetteFinder finder(views, match);
  std::vector<bool> wanted;
  for (const Face& face : faces) wanted.push_back(face.tier == kTierRejected);
  const Layers layers = cutAtSilhouettes(finder, vertices.frame, vertices.inverseDepth, triangles, wanted);
  for (const LayerVertex& vertex : layers.vertices) vertices.add(vertex, finder.maps());

  const auto folded = [&](const glm::uvec3& t) { return vertices.folded(t); };
  std::vector<glm::uvec3> pieces;
  std::vector<bool> replaced(triangles.size(), false);
  std::size_t surfaces = 0;
  for (const LayerSplit& split : layers.splits) {
    if (std::ranges::any_of(split.surface, folded)) continue;
    replaced[split.triangle] = true;
    pieces.insert(pieces.end(), split.surface.begin(), split.surface.end());
  }
  surfaces = pieces.size();
  for (const LayerSplit& split : layers.splits)
    if (replaced[split.triangle]) std::ranges::copy_if(split.behind, std::back_inserter(pieces), std::not_fn(folded));

  // Folded triangles between two surfaces show neither surface and are removed.
  const auto betweenSurfaces = [&](const glm::uvec3& t) {
    const auto surface = [&](unsigned v) {
      return finder.surface(glm::dvec2(vertices.frame[v]), vertices.inverseDepth[v]);
    };
    const SurfaceSample a = surface(t.x), b = surface(t.y), c = surface(t.z);
    return finder.apart(a, b) || finder.apart(b, c) || finder.apart(c, a);
  };
  std::vector<Face> kept;
  for (std::size_t t = 0; t < faces.size(); ++t)
    if (!replaced[t] && !(folded(triangles[t]) && betweenSurfaces(triangles[t]))) kept.push_back(faces[t]);
  const std::vector<TriangleLabel> labels = labelTriangles(views, match, vertices.frame, vertices.matched, pieces);
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    const bool inFrame = p < surfaces;
    kept.push_back(
        {pieces[p], inFrame && labels[p].agrees() ? kTierConsistent : kTierRejected, labels[p].ecc, inFrame});
  }
  faces = std::move(kept);
}

// Removes the vertices that layers added and no face uses.
void dropUnused(Vertices& vertices, std::size_t first, std::vector<Face>& faces) {
  std::vector<bool> keep(vertices.count(), true);
  std::fill(keep.begin() + std::ptrdiff_t(first), keep.end(), false);
  for (const Face& face : faces)
    for (int k = 0; k < 3; ++k) keep[face.corner[k]] = true;
  std::vector<unsigned> number(keep.size());
  unsigned next = 0;
  for (std::size_t v = 0; v < keep.size(); ++v) number[v] = keep[v] ? next++ : 0;
  for (Face& face : faces)
    for (int k = 0; k < 3; ++k) face.corner[k] = number[face.corner[k]];
  vertices.keepOnly(keep);
}

}  // namespace

CellMesh buildMesh(std::span<const Camera> stored, std::span<const MatchView> views, const DenseMatch& match,
                   TriangleFilter filter) {
  const std::size_t d = views.size();
  CellMesh result;
  MorphMesh& mesh = result.mesh;
  Vertices vertices(stored, views, match);
  const std::vector<glm::uvec3> triangles = triangulateAndRepair(vertices);
  const std::vector<TriangleLabel> labels = labelTriangles(views, match, vertices.frame, vertices.matched, triangles);
  std::vector<Face> faces;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const bool agrees = labels[t].agrees() && !vertices.folded(triangles[t]) &&
                        (filter == TriangleFilter::consistency || homogeneous(vertices.planes, triangles[t]));
    faces.push_back({triangles[t], agrees ? kTierConsistent : kTierRejected, labels[t].ecc, true});
  }
  const std::size_t before = vertices.count();
  if (match.depthKnown) layer(views, match, vertices, triangles, faces);
  dropUnused(vertices, before, faces);

  double covered = 0, weighted = 0;
  std::ranges::stable_sort(faces, {}, &Face::tier);
  for (const Face& face : faces) {
    mesh.triangles.push_back(face.corner);
    mesh.tier.push_back(face.tier);
    mesh.ecc.push_back(face.ecc);
    if (face.tier != kTierConsistent) continue;
    const double size = 0.5 * double(twiceArea(vertices.frame, face.corner)) / (kGridPerPixel * kGridPerPixel);
    covered += size;
    weighted += size * double(face.ecc);
  }
  result.quality.coverage = covered / (double(match.good.width) * double(match.good.height));
  if (covered > 0) result.quality.ecc = weighted / covered;

  mesh.match = vertices.stored;
  mesh.planes = vertices.planes;
  mesh.ratio.resize(d);
  std::vector<double> residuals, level;
  std::vector<Camera> cameras;
  for (std::size_t i = 0; i < d; ++i) cameras.push_back({views[i].camera.intrinsics, stored[i].pose});
  for (std::size_t v = 0; v < vertices.frame.size(); ++v) {
    std::vector<glm::dvec2> pixels;
    for (std::size_t i = 0; i < d; ++i) pixels.emplace_back(vertices.matched[i][v]);
    const RangePrior prior{vertices.inverseDepth[v], kPriorLevels * double(match.inverseDepthStep)};
    const RangeFit range = triangulate(match.frame, cameras, pixels, prior, kNoisePx);
    mesh.inverseDistance.push_back(float(range.inverseDistance));
    mesh.uncertainty.push_back(float(range.uncertainty));
    for (std::size_t i = 0; i < d; ++i) mesh.ratio[i].push_back(float(range.ratio[i]));
    residuals.push_back(range.residualPx);
    level.push_back(double(match.inverseDepthStep) * range.perInverseDepth);
  }
  widenUncertainty(mesh, level);
  if (!residuals.empty()) {
    const auto middle = residuals.begin() + std::ptrdiff_t(residuals.size() / 2);
    std::nth_element(residuals.begin(), middle, residuals.end());
    result.quality.residualPx = *middle;
  }
  return result;
}

}  // namespace ibr
