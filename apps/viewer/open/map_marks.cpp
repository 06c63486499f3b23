// SPDX-License-Identifier: Apache-2.0
#include "viewer/open/map_marks.h"

#include <glm/common.hpp>

namespace ibr::app {

MapMarks mapMarks(std::vector<glm::dvec2> points, std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs) {
  MapMarks marks;
  marks.low = marks.high = points.front();
  for (const glm::dvec2& point : points) {
    marks.low = glm::min(marks.low, point);
    marks.high = glm::max(marks.high, point);
  }
  std::vector<glm::dvec2> middles;
  for (const auto& [a, b] : pairs) middles.push_back(0.5 * (points[a] + points[b]));
  for (const std::uint32_t i : thinned(middles, kMaxMapMarks))
    marks.lines.push_back({points[pairs[i].first], points[pairs[i].second]});
  marks.photographs = PointMap(std::move(points));
  return marks;
}

}  // namespace ibr::app
