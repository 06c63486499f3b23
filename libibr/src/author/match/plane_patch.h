// SPDX-License-Identifier: Apache-2.0
// Photometric similarity of the members around a point on a given plane, and the positions of greatest similarity.
#pragma once

#include <span>
#include <vector>

#include "author/sweep/plane_maps.h"
#include "ibr/image.h"

namespace ibr {

class PlanePatches {
 public:
  /// `grey`: 1 channel each, 0 … 255. With poses, points stay on their epipolar lines. Keeps a reference to `grey`.
  PlanePatches(std::span<const ImageF> grey, std::span<const Camera> cameras, bool posed);

  /// Returns the zero-mean normalised correlation of 9×9 windows of the first member with the other members' windows,
  /// mapped by the plane: the minimum over the members; −1 if a member does not see a whole window. `at`: position of
  /// the window's centre in each member, px.
  double correlation(const PlaneMaps& plane, std::span<const glm::dvec2> at) const;

  /// Moves `at[1]` … by at most `reach` px to maximise the correlation with the first member. Gauss–Newton on
  /// displacement, gain and offset (with poses: on one inverse depth). Returns the correlation; positions change only
  /// if the correlation grows.
  double align(const PlaneMaps& plane, std::span<glm::dvec2> at, double reach) const;

 private:
  struct Window;
  bool sample(std::size_t member, const glm::dmat3& plane, glm::dvec2 first, glm::dvec2 centre, Window& window) const;

  std::span<const ImageF> grey_;
  std::vector<FrameToMember> maps_;
  bool posed_;
};

}  // namespace ibr
