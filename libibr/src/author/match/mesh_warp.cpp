// SPDX-License-Identifier: Apache-2.0
#include "author/match/mesh_warp.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <opencv2/calib3d.hpp>

#include "author/cgal/delaunay.h"
#include "author/match/vertices.h"
#include "base/raster.h"

namespace ibr {
namespace {

constexpr double kMaxPlaneErrorPx = 3.0, kMaxEpipolarPx = 1.0;
constexpr int kMinOnPlane = 12, kMinEpipolar = 16;
constexpr double kConfidence = 0.9999;
constexpr int kMaxIterations = 10000;
constexpr std::size_t kNeighbours = 8;
constexpr float kMaxNeighbourErrorPx = 4.0f;  // px from the neighbours' median, plus twice their median spread

std::vector<cv::Point2f> cvPoints(const std::vector<glm::vec2>& points) {
  std::vector<cv::Point2f> result;
  for (const glm::vec2 p : points) result.emplace_back(p.x, p.y);
  return result;
}

cv::Matx33d dominantHomography(const PointPairs& pairs, glm::ivec2 size, glm::ivec2 otherSize) {
  const cv::Matx33d stretched(double(otherSize.x) / size.x, 0, 0, 0, double(otherSize.y) / size.y, 0, 0, 0, 1);
  if (int(pairs.from.size()) < kMinOnPlane) return stretched;
  std::vector<std::uint8_t> inliers;
  const cv::Mat found = cv::findHomography(cvPoints(pairs.from), cvPoints(pairs.to), cv::USAC_MAGSAC, kMaxPlaneErrorPx,
                                           inliers, kMaxIterations, kConfidence);
  if (found.empty() || std::ranges::count(inliers, 1) < kMinOnPlane) return stretched;
  return cv::Matx33d(found);
}

glm::vec2 mapped(const cv::Matx33d& h, glm::vec2 p) {
  const cv::Vec3d q = h * cv::Vec3d(double(p.x), double(p.y), 1.0);
  const double w = std::max(q[2], 1e-6);
  return {q[0] / w, q[1] / w};
}

float middle(std::vector<float>& values) {
  const auto at = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// Matches with their residuals from a homography.
struct Anchors {
  std::vector<glm::vec2> at, off, to;

  std::size_t count() const { return at.size(); }
  void keepOnly(const std::vector<bool>& keep) {
    ibr::keepOnly(at, keep);
    ibr::keepOnly(off, keep);
    ibr::keepOnly(to, keep);
  }
  std::vector<glm::uvec3> triangulate() const {
    return delaunayTriangles(std::vector<glm::dvec2>(at.begin(), at.end()));
  }
  bool folded(const glm::uvec3& t) const {
    const glm::vec2 a = to[t.y] - to[t.x], b = to[t.z] - to[t.x];
    return !(a.x * b.y - a.y * b.x > 0);
  }

  // Drops matches whose residual is far from the median of their neighbours' residuals.
  void dropOutliers() {
    std::vector<bool> keep(count(), true);
    std::vector<std::pair<float, std::size_t>> near;
    for (std::size_t a = 0; a < count(); ++a) {
      near.clear();
      for (std::size_t b = 0; b < count(); ++b)
        if (b != a) near.emplace_back(glm::dot(at[b] - at[a], at[b] - at[a]), b);
      const std::size_t n = std::min(kNeighbours, near.size());
      if (n < 3) continue;
      std::partial_sort(near.begin(), near.begin() + std::ptrdiff_t(n), near.end());
      std::vector<float> x, y, spread;
      for (std::size_t k = 0; k < n; ++k) x.push_back(off[near[k].second].x), y.push_back(off[near[k].second].y);
      const glm::vec2 centre(middle(x), middle(y));
      for (std::size_t k = 0; k < n; ++k) spread.push_back(glm::distance(off[near[k].second], centre));
      keep[a] = glm::distance(off[a], centre) <= kMaxNeighbourErrorPx + 2 * middle(spread);
    }
    keepOnly(keep);
  }
};

Anchors anchorsOf(const PointPairs& pairs, const cv::Matx33d& plane) {
  Anchors anchors;
  if (int(pairs.from.size()) < kMinEpipolar) return anchors;
  std::vector<std::uint8_t> inliers;
  cv::findFundamentalMat(cvPoints(pairs.from), cvPoints(pairs.to), cv::USAC_MAGSAC, kMaxEpipolarPx, kConfidence,
                         kMaxIterations, inliers);
  if (std::ranges::count(inliers, 1) < kMinEpipolar) return anchors;
  for (std::size_t m = 0; m < pairs.from.size(); ++m) {
    if (!inliers[m]) continue;
    anchors.at.push_back(pairs.from[m]);
    anchors.to.push_back(pairs.to[m]);
    anchors.off.push_back(pairs.to[m] - mapped(plane, pairs.from[m]));
  }
  anchors.dropOutliers();
  return anchors;
}

}  // namespace

ImageF meshWarp(const PointPairs& pairs, glm::ivec2 size, glm::ivec2 otherSize) {
  const cv::Matx33d plane = dominantHomography(pairs, size, otherSize);
  ImageF map(size.x, size.y, 2);
  for (int y = 0; y < size.y; ++y)
    for (int x = 0; x < size.x; ++x) {
      const glm::vec2 to = mapped(plane, {float(x) + 0.5f, float(y) + 0.5f});
      map.pixel(x, y)[0] = to.x;
      map.pixel(x, y)[1] = to.y;
    }
  Anchors anchors = anchorsOf(pairs, plane);
  if (anchors.count() == 0) return map;
  // Anchors on the border have no residual: the homography holds there.
  constexpr int kSteps = 4;
  for (int s = 0; s < kSteps; ++s)
    for (const glm::vec2 side :
         {glm::vec2(s, 0), glm::vec2(kSteps, s), glm::vec2(kSteps - s, kSteps), glm::vec2(0, kSteps - s)}) {
      const glm::vec2 at = side / float(kSteps) * glm::vec2(size);
      anchors.at.push_back(at);
      anchors.to.push_back(mapped(plane, at));
      anchors.off.emplace_back(0.0f);
    }
  for (const glm::uvec3& t : triangulateAndRepair(anchors))
    forTrianglePixels(anchors.at[t.x], anchors.at[t.y], anchors.at[t.z], size.x, size.y,
                      [&](int x, int y, const glm::dvec3& weights) {
                        const glm::vec3 w(weights);
                        const glm::vec2 off = w.x * anchors.off[t.x] + w.y * anchors.off[t.y] + w.z * anchors.off[t.z];
                        const glm::vec2 to = mapped(plane, {float(x) + 0.5f, float(y) + 0.5f}) + off;
                        map.pixel(x, y)[0] = to.x;
                        map.pixel(x, y)[1] = to.y;
                      });
  return map;
}

}  // namespace ibr
