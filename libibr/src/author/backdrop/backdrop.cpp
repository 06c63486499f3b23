// SPDX-License-Identifier: Apache-2.0
#include "author/backdrop/backdrop.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <numeric>

#include "author/backdrop/complete_depth.h"
#include "author/cgal/delaunay.h"
#include "author/match/quadtree.h"

namespace ibr {
namespace {

constexpr double kAffine = 1.0;       // px of parallax at the step
constexpr float kStretched = 1.5f;    // change of parallax along an edge, in its length
constexpr float kKnownShare = 0.05f;  // one standard deviation of known values, of themselves

struct Vertex {
  glm::dvec2 at;     // px of the depth's picture
  glm::ivec2 pixel;  // whose depth it has
};

std::vector<Vertex> pickVertices(const ImageF& depth, double parallaxPx, int spacing) {
  const int width = depth.width, height = depth.height;
  ImageF parallax(width, height, 2);
  for (std::size_t at = 0; at < depth.values.size(); ++at)
    parallax.values[2 * at] = float(parallaxPx * double(depth.values[at]));
  const BlockSizes sizes{.largest = 32, .smallest = spacing, .atEdges = spacing, .affine = kAffine};
  std::vector<Vertex> vertices;
  for (const glm::ivec2 pixel : meshVertices(Image8(width, height, 1, 1), {&parallax, 1}, sizes))
    vertices.push_back({glm::dvec2(pixel) + 0.5, pixel});
  const auto along = [&](double u, double v) {
    vertices.push_back({{u, v}, {std::min(int(u), width - 1), std::min(int(v), height - 1)}});
  };
  const int columns = (width + 2 * spacing - 1) / (2 * spacing), rows = (height + 2 * spacing - 1) / (2 * spacing);
  for (int i = 0; i <= columns; ++i)
    for (const int v : {0, height}) along(double(i) * width / columns, v);
  for (int j = 1; j < rows; ++j)
    for (const int u : {0, width}) along(u, double(j) * height / rows);
  return vertices;
}

// Both ends of a panorama's rows are one place, and so is each pole.
ImageF closedAround(ImageF depth) {
  const int right = depth.width - 1;
  for (int y = 0; y < depth.height; ++y)
    depth.pixel(0, y)[0] = depth.pixel(right, y)[0] = 0.5f * (depth.pixel(0, y)[0] + depth.pixel(right, y)[0]);
  for (const int y : {0, depth.height - 1}) {
    float* row = &depth.pixel(0, y)[0];
    std::fill_n(row, depth.width, std::accumulate(row, row + depth.width, 0.0f) / float(depth.width));
  }
  return depth;
}

}  // namespace

glm::ivec2 backdropSize(const Intrinsics& stored) {
  const int side = stored.model == CameraModel::equirectangular ? kPanoramaSide : kBackdropSide;
  const double scale = std::min(1.0, double(side) / std::max(stored.width, stored.height));
  return {std::max(1, int(std::lround(stored.width * scale))), std::max(1, int(std::lround(stored.height * scale)))};
}

CellMesh buildBackdrop(const Camera& stored, const ImageF& inverseDepth, const Image8& colours,
                       const BackdropOptions& options) {
  return buildBackdrop(stored, inverseDepth, completeDepth(inverseDepth, colours), options);
}

CellMesh buildBackdrop(const Camera& stored, const ImageF& inverseDepth, const ImageF& depth,
                       const BackdropOptions& options) {
  const Intrinsics& k = stored.intrinsics;
  const bool panorama = k.model == CameraModel::equirectangular;
  const ImageF completed = panorama ? closedAround(depth) : depth;
  const glm::dvec2 scale(double(k.width) / completed.width, double(k.height) / completed.height);
  const double focalPx = panorama ? completed.width / (2 * std::numbers::pi) : std::max(k.fx / scale.x, k.fy / scale.y);
  const double parallaxPx = options.step * focalPx;  // of inverse depth 1
  const double cutPx = options.cut > 0 ? parallaxPx * options.cut / options.step : parallaxPx;
  const std::vector<Vertex> vertices = pickVertices(completed, parallaxPx, options.spacing);

  CellMesh result;
  MorphMesh& mesh = result.mesh;
  mesh.match.resize(1);
  mesh.ratio.resize(1);
  std::vector<glm::dvec2> places;
  std::vector<bool> isKnown;
  std::vector<float> parallax;
  for (const Vertex& vertex : vertices) {
    const glm::dvec2 match = vertex.at * scale;
    const glm::dvec3 ray = unproject(k, match);
    const float w = completed.pixel(vertex.pixel.x, vertex.pixel.y)[0];
    places.push_back(vertex.at);
    mesh.match[0].emplace_back(match);
    mesh.ratio[0].push_back(1.0f);
    mesh.inverseDistance.push_back(float(panorama ? double(w) : double(w) * -ray.z));
    isKnown.push_back(inverseDepth.pixel(vertex.pixel.x, vertex.pixel.y)[0] >= 0);
    mesh.uncertainty.push_back((isKnown.back() ? kKnownShare : 1.0f) * mesh.inverseDistance.back());
    parallax.push_back(float(cutPx * double(w)));
  }
  const auto stretched = [&](const glm::uvec3& t) {
    for (int i = 0; i < 3; ++i) {
      const unsigned a = t[i], b = t[(i + 1) % 3];
      if (std::abs(parallax[a] - parallax[b]) > kStretched * float(glm::distance(places[a], places[b]))) return true;
    }
    return false;
  };
  const std::vector<glm::uvec3> triangles = delaunayTriangles(places);
  for (const Tier tier : {kTierAgrees, kTierRejected})
    for (const glm::uvec3& t : triangles) {
      if (stretched(t) != (tier == kTierRejected)) continue;
      mesh.triangles.push_back(t);
      mesh.tier.push_back(tier);
      mesh.ecc.push_back(1.0f);
    }
  const auto count =
      std::count_if(inverseDepth.values.begin(), inverseDepth.values.end(), [](float w) { return w >= 0; });
  result.quality.coverage = double(count) / double(inverseDepth.values.size());
  return result;
}

}  // namespace ibr
