// SPDX-License-Identifier: Apache-2.0
// Tiles of an image that meshes certainly cover. Pure.
//
// For any triangles in the plane, sum their directed borders. The winding number of the sum around a point is the sum
// of the orientations of the triangles that contain the point. A point with a winding number other than 0 is covered,
// whether the mesh folds or not. Edges between equally oriented neighbours cancel, so the rest, the outline, is short.
// A tile of the image that the outline does not touch is covered entirely or not at all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <memory_resource>
#include <optional>
#include <span>
#include <vector>

namespace ibr {

class CoverMask {
 public:
  static constexpr int kTile = 16;  // px

  /// `marginPx`: largest difference between the device's rasterisation and the computed outline, px.
  CoverMask(int width, int height, double marginPx,
            std::pmr::memory_resource* memory = std::pmr::get_default_resource());

  /// A directed edge of an outline, px from the image's corner; may lie anywhere. It may stand for a chain of edges
  /// that has the same ends and stays within `marginPx` of the edge: around all other points both wind alike.
  struct Edge {
    glm::dvec2 from, to;
    double marginPx = 0;
  };
  /// Marks the tiles that lie entirely inside the outline. Time: edges × tiles that each touches, plus tiles / 64.
  void add(std::span<const Edge> outline);
  bool covered(int column, int row) const { return covered_[word(row, column / 64)] >> (unsigned(column) % 64) & 1u; }

  struct Rectangle {
    double left, top, right, bottom;  // px
  };
  /// Calls `visit` with rectangles that together contain everything that is not covered, and the margin around it.
  template <class Visit>
  void forOpen(Visit&& visit) {
    std::erase_if(open_, [&](glm::ivec2 block) {
      const std::optional<Rectangle> open = openIn(block.x, block.y);
      if (open) visit(*open);
      return !open;
    });
  }

 private:
  static constexpr int kBlock = 8;  // tiles; one rectangle per block

  std::size_t word(int row, int column) const { return std::size_t(row) * std::size_t(words_) + std::size_t(column); }
  std::optional<Rectangle> openIn(int x, int y) const;
  void touch(const Edge& edge);
  void cross(const Edge& edge);

  int width_, height_, columns_, rows_, words_;
  double margin_;
  // Bits of tiles, 64 a word; rows start with a word. Bits beyond the last column count as covered.
  std::pmr::vector<std::uint64_t> covered_;
  std::pmr::vector<glm::ivec2> open_;        // first tiles of the blocks that may be open; covered ones stay covered
  std::pmr::vector<std::uint64_t> touched_;  // by the outline that is being added
  std::pmr::vector<std::uint64_t> crossed_;  // tiles whose value in winding_ was changed
  std::pmr::vector<std::int32_t> winding_;   // of the outline: change from the tile's left neighbour to the tile, at
                                             // their centres; 0 between two calls
};

}  // namespace ibr
