// SPDX-License-Identifier: Apache-2.0
#include "shared/camera/point_map.h"

#include <algorithm>
#include <cmath>

namespace ibr::app {
namespace {

std::vector<std::uint32_t> finiteOf(std::span<const glm::dvec2> points) {
  std::vector<std::uint32_t> finite;
  for (std::uint32_t i = 0; i < points.size(); ++i)
    if (std::isfinite(points[i].x) && std::isfinite(points[i].y)) finite.push_back(i);
  return finite;
}

// Returns the indices of points of which no two have the same coordinates, each the first of its copies.
std::vector<std::uint32_t> distinctOf(std::span<const glm::dvec2> points) {
  std::vector<std::uint32_t> distinct = finiteOf(points);
  std::ranges::sort(distinct, [&](std::uint32_t a, std::uint32_t b) {
    if (points[a].x != points[b].x) return points[a].x < points[b].x;
    return points[a].y != points[b].y ? points[a].y < points[b].y : a < b;
  });
  const auto copies =
      std::ranges::unique(distinct, [&](std::uint32_t a, std::uint32_t b) { return points[a] == points[b]; });
  distinct.erase(copies.begin(), copies.end());
  return distinct;
}

}  // namespace

std::vector<std::uint32_t> thinned(std::span<const glm::dvec2> points, std::size_t max) {
  std::vector<std::uint32_t> finite = finiteOf(points), kept;
  if (finite.size() <= max) return finite;
  glm::dvec2 low = points[finite.front()], high = low;
  for (const std::uint32_t i : finite) {
    low = glm::min(low, points[i]);
    high = glm::max(high, points[i]);
  }
  const std::size_t side = std::size_t(std::sqrt(double(max)));
  const double extent = std::max(high.x - low.x, high.y - low.y);
  std::vector<bool> taken(side * side);
  for (const std::uint32_t i : finite) {
    const glm::dvec2 share = extent > 0 ? (points[i] - low) / extent : glm::dvec2(0);
    const auto along = [&](double part) { return std::min(side - 1, std::size_t(part * double(side))); };
    const std::size_t square = along(share.y) * side + along(share.x);
    if (taken[square]) continue;
    taken[square] = true;
    kept.push_back(i);
  }
  return kept;
}

PointMap::PointMap(std::vector<glm::dvec2> points)
    : points_(std::move(points)), drawn_(thinned(points_, kMaxMapMarks)) {
  tree_ = makeBoxTree(distinctOf(points_), [this](std::uint32_t i) {
    const glm::dvec3 point(points_[i], 0);
    return Box{point, point};
  });
}

std::optional<std::size_t> PointMap::nearest(glm::dvec2 at, double reach, std::size_t* compared) const {
  constexpr double kMargin = 1e-12;  // relative, for the rounding of distances
  std::optional<std::size_t> best;
  double least = reach;
  const auto bound = [&](const Box& box) { return (1 - kMargin) * distanceToBox(box, {at, 0}); };
  searchBoxes(tree_, least, bound, [&](std::uint32_t i) {
    if (compared) ++*compared;
    const double distance = glm::distance(points_[i], at);
    if (distance < least || (distance == least && (!best || i < *best))) {
      least = distance;
      best = i;
    }
    return least;
  });
  return best;
}

}  // namespace ibr::app
