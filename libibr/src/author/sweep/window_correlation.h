// SPDX-License-Identifier: Apache-2.0
// What a plane of the sweep costs: how unlike the members are, brought to the frame through it.
//
//   cost(pixel) = mean over pairs of members of 1 − ZNCC of 5×5 windows, 0 … kCostLargest; more where the plane is
//   near,
//                 above all in windows without texture; of pairs in which neither is masked there, where there are any
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

/// A member's grey picture in the sweep's resolution, 0 … 255.
struct SweepView {
  Camera camera;
  ImageF grey;
  Image8 mask = {};  // of grey's size; 0: a window there, or its neighbour, holds what is masked. Or empty
};

inline constexpr int kCostLargest = 240;  // perfectly opposite; 120: no correlation, no texture

/// A member's picture as the frame would see it if everything lay on one plane. Beyond the picture's border its edge is
/// repeated; `first` and `last` bound the pixels of each row that are inside.
struct WarpedView {
  static constexpr float kUnits = 4.0f;  // a grey level in the units of `grey`, which are about mid-grey

  ImageF grey;
  std::vector<int> first, last;
  std::vector<std::uint8_t> ignored;  // 1 where the view's mask is 0; empty where it has none
  std::vector<int> corner;            // of the row at hand: where each pixel's four neighbours begin
  std::vector<float> fu, fv;          // and its place between them

  WarpedView(int width, int height);
};

/// `map` leads from (x, y, 1), px of the frame, to the member's homogeneous px.
void warp(const SweepView& view, const glm::dmat3& map, WarpedView& out);

/// Keeps its working memory from one plane to the next. Not for several threads at once.
class WindowCorrelation {
 public:
  WindowCorrelation(int members, int width, int height);

  /// Costs of one plane into `cost` (height × width). `nearness`, linear in the picture as the plane's inverse depth,
  /// n·(x, y, 1), is 0 at the farthest level and 1 at the nearest.
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
