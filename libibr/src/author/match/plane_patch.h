// SPDX-License-Identifier: Apache-2.0
// Whether the members look alike around a place if it lies on a given plane, and where they look most alike.
#pragma once

#include <span>
#include <vector>

#include "author/sweep/plane_maps.h"
#include "ibr/image.h"

namespace ibr {

class PlanePatches {
 public:
  /// `grey`: 1 channel each, 0 … 255. With poses, places stay on their epipolar lines. Keeps a reference to `grey`.
  PlanePatches(std::span<const ImageF> grey, std::span<const Camera> cameras, bool posed);

  /// The zero-mean normalised correlation of 9×9 windows of the first member with what the plane says the others see
  /// there, the least member's; −1 where one does not see it all. `at`: where the members are taken to see the window's
  /// centre.
  double correlation(const PlaneMaps& plane, std::span<const glm::dvec2> at) const;

  /// Moves `at[1]` … to where the members correlate most with the first, at most `reach` px, by Gauss–Newton on
  /// displacement, gain and offset (with poses: on one inverse depth). Returns the correlation there; places only move
  /// where it grows.
  double align(const PlaneMaps& plane, std::span<glm::dvec2> at, double reach) const;

 private:
  struct Window;
  bool sample(std::size_t member, const glm::dmat3& plane, glm::dvec2 first, glm::dvec2 centre, Window& window) const;

  std::span<const ImageF> grey_;
  std::vector<FrameToMember> maps_;
  bool posed_;
};

}  // namespace ibr
