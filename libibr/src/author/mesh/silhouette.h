// SPDX-License-Identifier: Apache-2.0
// Locates the edge of a surface in front of another one.
//
//   The dense depth jumps between two pixels of the mean frame, near the surface's true border: the matcher's windows
//   fatten or erode foregrounds. Near the jump, the members' colours, sampled at the near surface's depth, change most
//   across the true border
#pragma once

#include <glm/vec2.hpp>
#include <optional>
#include <span>
#include <vector>

#include "author/geometry/mean_frame.h"
#include "author/match/match.h"

namespace ibr {

/// A matched pixel of the frame and the plane of its neighbourhood.
struct SurfaceSample {
  glm::dvec2 pixel;
  double inverseDepth;
  glm::dvec2 slope{0.0};  // of the inverse depth, per px

  /// Extrapolates the inverse depth by at most `most`; never below 0, infinity.
  double at(glm::dvec2 other, double most) const;
};

class SilhouetteFinder {
 public:
  /// Keeps references to the arguments.
  SilhouetteFinder(std::span<const MatchView> views, const DenseMatch& match);

  /// Returns the plane through the pixel's own inverse depth, fitted to pixels near in the image and in depth.
  SurfaceSample surface(glm::dvec2 pixel, double inverseDepth) const;

  /// Returns the parallax between members, px, if the inverse depth at a pixel changes from `a` to `b`.
  double parallax(glm::dvec2 pixel, double a, double b) const;

  /// True if two pixels lie on different surfaces: neither's plane passes through the other.
  bool apart(const SurfaceSample& a, const SurfaceSample& b) const;

  /// Returns the position of the near surface's edge between `near` and `far`, within (0, 1); nullopt if the depth does
  /// not jump between them.
  std::optional<double> between(const SurfaceSample& near, const SurfaceSample& far) const;

  /// Maximum change of inverse depth along an extrapolated plane.
  double maxExtrapolation() const;

  const std::vector<FrameToMember>& maps() const { return maps_; }

 private:
  double contrast(glm::dvec2 inside, glm::dvec2 outside, double inverseDepth) const;

  std::span<const MatchView> views_;
  const DenseMatch& match_;
  std::vector<FrameToMember> maps_;
};

}  // namespace ibr
