// SPDX-License-Identifier: Apache-2.0
// Marks on the map of an item, prepared once: a frame draws a bounded number of them.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <utility>
#include <vector>

#include "shared/camera/point_map.h"

namespace ibr::app {

/// In the map's coordinates.
struct MapMarks {
  glm::dvec2 low{0}, high{0};  // corners around the photographs
  PointMap photographs;
  std::vector<std::array<glm::dvec2, 2>> lines;  // between photographs of a cell, at most kMaxMapMarks
};

/// `points`: at least one. `pairs`: indices into `points`.
MapMarks mapMarks(std::vector<glm::dvec2> points, std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs);

}  // namespace ibr::app
