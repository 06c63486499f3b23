// SPDX-License-Identifier: Apache-2.0
// Points of a flat map, prepared once, so that drawing and picking take a time that hardly grows with their number.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <optional>
#include <span>
#include <vector>

#include "shared/camera/box_tree.h"

namespace ibr::app {

/// Maximum number of points, and of lines, that a frame draws on a map.
inline constexpr std::size_t kMaxMapMarks = 4096;

/// Returns indices of at most `max` points, ascending: of all finite points if they are few enough, else of the first
/// point in each square of a grid over all. `max`: at least 1.
std::vector<std::uint32_t> thinned(std::span<const glm::dvec2> points, std::size_t max);

class PointMap {
 public:
  PointMap() = default;
  explicit PointMap(std::vector<glm::dvec2> points);

  std::size_t size() const noexcept { return points_.size(); }
  glm::dvec2 operator[](std::size_t point) const noexcept { return points_[point]; }
  /// Indices of the points to draw, at most kMaxMapMarks.
  std::span<const std::uint32_t> drawn() const noexcept { return drawn_; }
  /// Returns the point nearest to `at`, the first of equally near ones; nullopt if none is within `reach`. `compared`:
  /// increased by the number of points that the search compared.
  std::optional<std::size_t> nearest(glm::dvec2 at, double reach, std::size_t* compared = nullptr) const;

 private:
  std::vector<glm::dvec2> points_;
  std::vector<std::uint32_t> drawn_;
  BoxTree tree_;
};

}  // namespace ibr::app
