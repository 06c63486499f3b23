// SPDX-License-Identifier: Apache-2.0
#include "scene/capture_spacing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "base/halved_tree.h"
#include "base/median.h"
#include "base/stop.h"

namespace ibr {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kMargin = 1e-9;  // relative, for the rounding of distances

struct Box : HalvedNode {
  glm::dvec3 low{kInfinity}, high{-kInfinity};
};

Box boundsOf(std::span<const glm::dvec3> positions) {
  Box box;
  for (const glm::dvec3 position : positions) {
    box.low = glm::min(box.low, position);
    box.high = glm::max(box.high, position);
  }
  return box;
}

auto byLongestSide(const Box& box, std::span<const glm::dvec3>) {
  const glm::dvec3 size = box.high - box.low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  return [axis](glm::dvec3 a, glm::dvec3 b) { return a[axis] < b[axis]; };
}

// Finds the nearest of all positions outside of one's own capture site.
class Neighbours {
 public:
  Neighbours(std::vector<glm::dvec3> positions, double siteSize)
      : positions_(std::move(positions)),
        boxes_(halvedTree(std::span(positions_), 8, boundsOf, byLongestSide)),
        siteSize_(siteSize) {}

  // Returns the distance; infinite without another site.
  double nearest(glm::dvec3 from) const {
    double best = kInfinity;
    std::array<std::uint32_t, kMaxHalvings> open;
    std::size_t count = 0;
    open[count++] = 0;
    while (count > 0) {
      const std::uint32_t at = open[--count];
      const Box& box = boxes_[at];
      if (!mayHoldNearer(box, from, best)) continue;
      if (box.second == 0) {
        for (std::uint32_t p = box.first; p < box.end; ++p)
          if (const double d = glm::distance(from, positions_[p]); d > siteSize_) best = std::min(best, d);
        continue;
      }
      const std::uint32_t first = at + 1, second = box.second;
      const bool firstIsNearer = leastDistance(boxes_[first], from) <= leastDistance(boxes_[second], from);
      open[count++] = firstIsNearer ? second : first;
      open[count++] = firstIsNearer ? first : second;
    }
    return best;
  }

 private:
  static double leastDistance(const Box& box, glm::dvec3 from) {
    return glm::length(glm::max(glm::max(box.low - from, from - box.high), glm::dvec3(0.0)));
  }
  bool mayHoldNearer(const Box& box, glm::dvec3 from, double best) const {
    if ((1 - kMargin) * leastDistance(box, from) > best) return false;
    const double most = glm::length(glm::max(glm::abs(box.low - from), glm::abs(box.high - from)));
    return (1 + kMargin) * most > siteSize_;
  }

  std::vector<glm::dvec3> positions_;
  std::vector<Box> boxes_;
  double siteSize_;
};

}  // namespace

double captureSpacing(std::span<const Camera> cameras, const std::stop_token& stop) {
  double extent = 0;
  std::vector<glm::dvec3> positions;
  for (const Camera& camera : cameras) {
    extent = std::max(extent, glm::distance(camera.pose.position, cameras[0].pose.position));
    positions.push_back(camera.pose.position);
  }
  const Neighbours neighbours(std::move(positions), 1e-6 * extent);
  std::vector<double> distances;
  for (const Camera& camera : cameras) {
    checkStop(stop, "computing the capture spacing");
    if (const double distance = neighbours.nearest(camera.pose.position); std::isfinite(distance))
      distances.push_back(distance);
  }
  return distances.empty() ? 1.0 : median(std::move(distances));
}

}  // namespace ibr
