// SPDX-License-Identifier: Apache-2.0
// Finds planned meshes that better meshes certainly hide, so that they need not be drawn. Pure; conservative: drawing a
// hidden mesh would not change a pixel.
//
// For any triangles in the plane, sum their directed borders. The winding number of the sum around a point is the sum
// of the orientations of the triangles that contain the point. A point with a winding number other than 0 is covered,
// whether the mesh folds or not. Edges between equally oriented neighbours cancel, so the rest, the outline, is short.
// A tile of the image that the outline does not touch is covered entirely or not at all.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "ibr/frame_plan.h"

namespace ibr {

class CoverMask {
 public:
  static constexpr int kTile = 16;  // px

  /// `marginPx`: largest difference between the device's rasterisation and the computed outline, px.
  CoverMask(int width, int height, double marginPx);

  /// A directed edge of an outline, px from the image's corner; may lie anywhere.
  struct Edge {
    glm::dvec2 from, to;
  };
  /// Marks the tiles that lie entirely inside the outline.
  void add(std::span<const Edge> outline);
  bool covered(int column, int row) const { return covered_[index(column, row)]; }

  struct Rectangle {
    double left, top, right, bottom;  // px
  };
  /// Rectangles that contain everything that is not covered, and the margin around it.
  std::vector<Rectangle> open() const;

 private:
  std::size_t index(int column, int row) const {
    return std::size_t(row) * std::size_t(columns_) + std::size_t(column);
  }
  void touch(const Edge& edge);
  void cross(const Edge& edge);

  int width_, height_, columns_, rows_;
  double margin_;
  std::vector<bool> covered_;
  std::vector<bool> touched_;  // by the outline that is being added
  std::vector<int> winding_;   // of the outline: change from the tile's left neighbour to the tile, at their centres
};

/// Marks cells that are hidden in all views of a plan with DrawOrder::ours (PlannedCell::hidden).
void markHidden(const Scene& scene, const SceneBounds& bounds, FramePlan& plan);

}  // namespace ibr
