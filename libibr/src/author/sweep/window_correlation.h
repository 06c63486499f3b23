// SPDX-License-Identifier: Apache-2.0
// Matching cost of a sweep plane: the dissimilarity of the members, warped to the frame through that plane.
//
//   cost(pixel) = mean over pairs of members of 1 − ZNCC of 5×5 windows, 0 … kMaxSweepCost. Pairs with a masked member
//                 are left out, if any pair remains. Near planes cost more, above all in windows without texture: far
//                 depth is the better guess without evidence
#pragma once

#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "ibr/camera.h"
#include "ibr/image.h"

namespace ibr {

/// A member's grey image at the sweep's resolution, 0 … 255.
struct SweepView {
  Camera camera;
  ImageF grey;
  Image8 mask = {};  // of grey's size; 0: the window at the pixel or its neighbour holds masked pixels. Or empty
};

inline constexpr int kMaxSweepCost = 240;  // perfectly opposite; 120: no correlation, no texture

/// A member's image warped to the frame as if everything lay on one plane. Beyond the image's border the edge is
/// repeated; `first` and `last` bound the pixels of each row that are inside.
struct WarpedView {
  static constexpr float kUnits = 4.0f;  // units of `grey` per grey level; `grey` is relative to mid-grey

  ImageF grey;
  std::vector<int> first, last;
  std::vector<std::uint8_t> ignored;  // 1 where the view's mask is 0; empty without a mask
  std::vector<int> corner;            // of the current row: offset of each pixel's four neighbours
  std::vector<float> fu, fv;          // and its position between them

  WarpedView(int width, int height);
};

/// `map`: from (x, y, 1), px of the frame, to the member's homogeneous px.
void warp(const SweepView& view, const glm::dmat3& map, WarpedView& out);

/// Keeps its working memory from plane to plane. Not thread-safe.
class WindowCorrelation {
 public:
  WindowCorrelation(int members, int width, int height);

  /// Writes the costs of one plane into `cost` (height × width). `nearness` is n·(x, y, 1), linear in the image like
  /// the plane's inverse depth: 0 at the farthest level and 1 at the nearest.
  void run(std::span<const WarpedView> warped, glm::dvec3 nearness, std::uint8_t* cost);

 private:
  void move(std::span<const WarpedView> warped, int in, std::optional<int> out);
  void addPair(std::span<const WarpedView> warped, int y, int i, int j, std::size_t product);
  void addMaskedPair(const WarpedView& a, const WarpedView& b, int y, int i, int j, std::size_t product, int first,
                     int last);
  void addVariances();
  void countPairs(std::span<const WarpedView> warped, int y);
  void costs(int y, glm::dvec3 nearness, std::uint8_t* out) const;

  int d_, width_, height_;
  std::vector<std::vector<float>> column_, sum_;  // of each member: value, square; then of each pair: product
  std::vector<float> total_, count_, variance_, zero_, pairs_;
};

}  // namespace ibr
