// SPDX-License-Identifier: Apache-2.0
// Sub-pixel depth: Gauss–Newton on one inverse depth, as Lucas & Kanade (1981) on a displacement.
//
//   patch of 11×11 px of the frame, plane in depth; only pixels that match and whose dense depth lies on that plane
//   each member's grey values there, brought to the same mean and spread; r_i their deviation from the members' mean
//   minimise Σ r_i² over a common change of the patch's inverse depth, held by the dense one where texture is weak
#pragma once

#include <span>
#include <vector>

#include "author/geometry/mean_frame.h"
#include "author/match/match.h"

namespace ibr {

class DepthRefiner {
 public:
  /// The match's poses are taken as exact. Keeps references.
  DepthRefiner(std::span<const MatchView> views, const DenseMatch& match);

  /// The inverse depth at the centre of a pixel of the frame; the dense one where nothing better is found.
  double at(int x, int y) const;
  const std::vector<FrameToMember>& maps() const { return maps_; }

 private:
  struct Patch;
  bool seen(glm::dvec2 pixel, double inverseDepth) const;
  bool gather(int x, int y, Patch& patch) const;
  double error(const Patch& patch, double change, double* step) const;

  const DenseMatch& match_;
  std::vector<FrameToMember> maps_;
  std::vector<ImageF> grey_;
  std::vector<Image8> masks_;
};

}  // namespace ibr
