// SPDX-License-Identifier: Apache-2.0
#include "author/backdrop/backdrop.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

#include "author/backdrop/complete_depth.h"
#include "author/cgal/delaunay.h"
#include "author/match/quadtree.h"

namespace ibr {
namespace {

constexpr double kMaxNonlinearPx = 1.0;   // tolerated deviation from linear parallax, px at the step
constexpr double kMaxStretch = 1.5;       // change of parallax along an edge, relative to its length
constexpr float kKnownDeviation = 0.05f;  // standard deviation of known values, relative to the value

struct Vertex {
  glm::dvec2 at;     // px of the depth map
  glm::ivec2 pixel;  // whose depth the vertex takes
};

std::vector<Vertex> pickVertices(const ImageF& depth, double parallaxPx, int spacing) {
  const int width = depth.width, height = depth.height;
  ImageF parallax(width, height, 2);
  for (std::size_t at = 0; at < depth.values.size(); ++at)
    parallax.values[2 * at] = float(parallaxPx * double(depth.values[at]));
  const BlockSizes sizes{.largest = 32, .smallest = spacing, .atEdges = spacing, .affine = kMaxNonlinearPx};
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

// Makes both ends of a panorama's rows equal, and each pole row constant: these pixels show the same direction.
ImageF closedPanorama(ImageF depth) {
  const int right = depth.width - 1;
  for (int y = 0; y < depth.height; ++y)
    depth.pixel(0, y)[0] = depth.pixel(right, y)[0] = 0.5f * (depth.pixel(0, y)[0] + depth.pixel(right, y)[0]);
  for (const int y : {0, depth.height - 1}) {
    float* row = &depth.pixel(0, y)[0];
    std::fill_n(row, depth.width, std::accumulate(row, row + depth.width, 0.0f) / float(depth.width));
  }
  return depth;
}

// Mesh of one member during construction.
class BackdropMesh {
 public:
  BackdropMesh(const Intrinsics& stored, const ImageF& depth, const BackdropOptions& options)
      : stored_(stored),
        depth_(depth),
        isPanorama_(stored.model == CameraModel::equirectangular),
        scale_(double(stored.width) / depth.width, double(stored.height) / depth.height) {
    const double focalPx =
        isPanorama_ ? depth.width / (2 * std::numbers::pi) : std::max(stored.fx / scale_.x, stored.fy / scale_.y);
    parallaxPx_ = options.step * focalPx;
    cutPx_ = options.cut > 0 ? options.cut * focalPx : parallaxPx_;
    mesh_.match.resize(1);
    mesh_.ratio.resize(1);
  }

  double parallaxPx() const { return parallaxPx_; }  // px of parallax for inverse depth 1, at the step

  unsigned addPoint(glm::dvec2 at, float depth, bool isKnown) {
    const glm::dvec2 match = at * scale_;
    mesh_.match[0].emplace_back(match);
    mesh_.ratio[0].push_back(1.0f);
    const double along = isPanorama_ ? 1.0 : -unproject(stored_, match).z;
    mesh_.inverseDistance.push_back(float(double(depth) * along));
    mesh_.uncertainty.push_back((isKnown ? kKnownDeviation : 1.0f) * mesh_.inverseDistance.back());
    points_.push_back({at, depth, isKnown});
    return unsigned(points_.size() - 1);
  }

  void addTriangles() {
    std::vector<glm::dvec2> places;
    for (const Point& point : points_) places.push_back(point.at);
    for (const glm::uvec3& t : delaunayTriangles(places)) {
      if (!isStretched(t))
        add(t);
      else if (points_[t[0]].isKnown && points_[t[1]].isKnown && points_[t[2]].isKnown)
        split(t);
    }
  }

  MorphMesh take() && { return std::move(mesh_); }

 private:
  struct Point {
    glm::dvec2 at;  // px of the depth map
    float depth;
    bool isKnown;
  };

  void add(const glm::uvec3& t) {
    mesh_.triangles.push_back(t);
    mesh_.tier.push_back(kTierConsistent);
    mesh_.ecc.push_back(1.0f);
  }

  bool isStretched(const glm::uvec3& t) const {
    for (int i = 0; i < 3; ++i) {
      const Point &a = points_[t[i]], &b = points_[t[(i + 1) % 3]];
      const double change = cutPx_ * std::abs(double(a.depth) - double(b.depth));
      if (change > kMaxStretch * glm::distance(a.at, b.at)) return true;
    }
    return false;
  }

  // Position on the way from a to b at which the depth changes from that of a to that of b.
  glm::dvec2 jump(const Point& a, const Point& b) const {
    constexpr double kMinEndShare = 0.1;  // min distance from either end, as a share of the edge
    const int count = int(std::ceil(2 * glm::distance(a.at, b.at)));
    int best = 0, balance = 0, most = 0;  // samples like a minus samples like b, up to the current one
    for (int i = 0; i < count; ++i) {
      const glm::ivec2 at = glm::ivec2(glm::mix(a.at, b.at, (i + 0.5) / count));
      const float here = depth_.pixel(std::min(at.x, depth_.width - 1), std::min(at.y, depth_.height - 1))[0];
      balance += std::abs(here - a.depth) < std::abs(here - b.depth) ? 1 : -1;
      if (balance > most) most = balance, best = i + 1;
    }
    return glm::mix(a.at, b.at, std::clamp(double(best) / count, kMinEndShare, 1 - kMinEndShare));
  }

  // Point of an edge where one surface ends and the other begins, with the depth of its end `side`.
  unsigned splitPoint(unsigned side, unsigned other) {
    const auto [it, isNew] = splitPoints_.try_emplace({side, other}, 0u);
    const Point &a = points_[std::min(side, other)], &b = points_[std::max(side, other)], &own = points_[side];
    if (isNew) it->second = addPoint(jump(a, b), own.depth, own.isKnown);
    return it->second;
  }

  // Splits a triangle across a depth jump: each surface continues to the position of the jump.
  void split(const glm::uvec3& t) {
    const auto difference = [&](int i) {
      return std::abs(points_[t[(i + 1) % 3]].depth - points_[t[(i + 2) % 3]].depth);
    };
    int apart = 0;  // the corner whose depth differs from the other two
    for (const int i : {1, 2})
      if (difference(i) < difference(apart)) apart = i;
    const unsigned a = t[apart], b = t[(apart + 1) % 3], c = t[(apart + 2) % 3];
    add({a, splitPoint(a, b), splitPoint(a, c)});
    add({splitPoint(b, a), b, c});
    add({splitPoint(b, a), c, splitPoint(c, a)});
  }

  const Intrinsics& stored_;
  const ImageF& depth_;
  bool isPanorama_;
  glm::dvec2 scale_;  // px of the stored photograph per px of the depth map
  double parallaxPx_, cutPx_;
  MorphMesh mesh_;
  std::vector<Point> points_;
  std::map<std::pair<unsigned, unsigned>, unsigned> splitPoints_;
};

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
  const bool panorama = stored.intrinsics.model == CameraModel::equirectangular;
  const ImageF completed = panorama ? closedPanorama(depth) : depth;
  BackdropMesh mesh(stored.intrinsics, completed, options);
  for (const Vertex& vertex : pickVertices(completed, mesh.parallaxPx(), options.spacing))
    mesh.addPoint(vertex.at, completed.pixel(vertex.pixel.x, vertex.pixel.y)[0],
                  inverseDepth.pixel(vertex.pixel.x, vertex.pixel.y)[0] >= 0);
  mesh.addTriangles();

  CellMesh result{std::move(mesh).take(), {}};
  const auto count =
      std::count_if(inverseDepth.values.begin(), inverseDepth.values.end(), [](float w) { return w >= 0; });
  result.quality.coverage = double(count) / double(inverseDepth.values.size());
  return result;
}

}  // namespace ibr
