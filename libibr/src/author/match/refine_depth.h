// SPDX-License-Identifier: Apache-2.0
// Sub-pixel depth: Gauss–Newton on one inverse depth, as Lucas & Kanade (1981) on a displacement.
//
//   Patch: 11×11 px of the frame, plane in depth; only matched pixels whose dense depth lies on that plane count. Each
//   member's grey values are normalised to equal mean and spread; r_i is their deviation from the members' mean.
//   Minimises Σ r_i² over a common change of inverse depth; the dense depth is the prior where texture is weak.
#pragma once

#include <span>
#include <vector>

#include "author/geometry/mean_frame.h"
#include "author/match/match.h"

namespace ibr {

class DepthRefiner {
 public:
  /// Takes the match's poses as exact. Keeps references to the arguments.
  DepthRefiner(std::span<const MatchView> views, const DenseMatch& match);

  /// Returns the inverse depth at the centre of a pixel of the frame; the dense depth if nothing better is found.
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
