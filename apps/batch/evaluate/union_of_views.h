// SPDX-License-Identifier: Apache-2.0
// Union of the photographs' fields of view: pixels that a renderer can be expected to cover.
#pragma once

#include <vector>

#include "ibr/scene.h"

namespace ibr::app {

class UnionOfViews {
 public:
  /// Stores the scene's cameras and the distance that 10 % of the cells' points are nearer than.
  explicit UnionOfViews(const Scene& scene);

  /// Returns every eighth pixel in x and y whose ray is inside one photograph's image from the near distance to
  /// infinity. Occlusion is ignored.
  std::vector<glm::ivec2> pixelsSeen(const Camera& view) const;

  double nearDistance() const noexcept { return nearDistance_; }

 private:
  std::vector<Camera> cameras_;
  double nearDistance_;
};

}  // namespace ibr::app
