// SPDX-License-Identifier: Apache-2.0
// Which planned meshes better ones hide for certain, so that they need not be drawn. Pure; conservative: what is called
// hidden would not have changed a pixel.
//
// For any triangles in the plane, the winding number of the sum of their directed borders around a point is the sum of
// the orientations of those that hold the point. Not 0 means covered, whether a mesh folds or not, and edges between
// equally oriented neighbours cancel: what is left of a mesh, its outline, is short. So an outline tells which tiles of
// the picture that it does not touch are covered.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "ibr/renderer.h"

namespace ibr {

class CoverMask {
 public:
  static constexpr int kTile = 16;  // px

  /// `marginPx`: what a device's drawing may differ by.
  CoverMask(int width, int height, double marginPx);

  /// A directed edge of an outline, px from the picture's corner; may lie anywhere.
  struct Edge {
    glm::dvec2 from, to;
  };
  void add(std::span<const Edge> outline);
  bool covered(int column, int row) const { return covered_[index(column, row)]; }

  struct Rectangle {
    double left, top, right, bottom;  // px
  };
  /// Hold everything that is not covered, and the margin around it.
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
  std::vector<bool> touched_;  // by the outline being added
  std::vector<int> winding_;   // of it: change from the tile's left neighbour to it, at their centres
};

/// Marks what is hidden in all views of a plan with our order (PlannedCell::hidden).
void markHidden(const Scene& scene, const SceneBounds& bounds, FramePlan& plan);

}  // namespace ibr
