// SPDX-License-Identifier: Apache-2.0
// Where a surface ends before another one.
//
//   the dense depth jumps between two pixels of the mean frame, somewhere near the surface's true border: windows of
//   the matcher fatten what stands in front, or wear it off near the jump, what all members show where the near surface
//   would be changes most across its border: that is it
#pragma once

#include <glm/vec2.hpp>
#include <optional>
#include <span>
#include <vector>

#include "author/geometry/mean_frame.h"
#include "author/match/match.h"

namespace ibr {

/// A matched pixel of the frame and the plane that its surroundings lie on.
struct SurfaceSample {
  glm::dvec2 pixel;
  double inverseDepth;
  glm::dvec2 slope{0.0};  // of the inverse depth, per px

  /// Extrapolated, not below infinity's 0; by no more than `most`.
  double at(glm::dvec2 other, double most) const;
};

class SilhouetteFinder {
 public:
  /// Keeps references.
  SilhouetteFinder(std::span<const MatchView> views, const DenseMatch& match);

  /// The plane through the pixel's own inverse depth, by what is near it in the picture and in depth.
  SurfaceSample surface(glm::dvec2 pixel, double inverseDepth) const;

  /// px that members move against each other if the inverse depth at a pixel changes from `a` to `b`.
  double parallax(glm::dvec2 pixel, double a, double b) const;

  /// Whether two pixels lie on different surfaces: neither's plane goes through the other.
  bool apart(const SurfaceSample& a, const SurfaceSample& b) const;

  /// The part of the way from `near` to `far`, within (0, 1), where the near surface ends; nullopt where the depth does
  /// not jump between them.
  std::optional<double> between(const SurfaceSample& near, const SurfaceSample& far) const;

  /// Change of inverse depth that a plane may be followed for.
  double mostExtrapolated() const;

  const std::vector<FrameToMember>& maps() const { return maps_; }

 private:
  double contrast(glm::dvec2 inside, glm::dvec2 outside, double inverseDepth) const;

  std::span<const MatchView> views_;
  const DenseMatch& match_;
  std::vector<FrameToMember> maps_;
};

}  // namespace ibr
