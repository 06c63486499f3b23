// SPDX-License-Identifier: Apache-2.0
// Where photographs look: what may be expected to be covered.
#pragma once

#include <vector>

#include "ibr/scene.h"

namespace ibr::app {

class UnionOfViews {
 public:
  /// Keeps the scene's cameras, and the distance than which a tenth of the cells' points are nearer.
  explicit UnionOfViews(const Scene& scene);

  /// Pixels of a view, one in every 8×8, whose rays lie in one photograph's picture from that near distance to
  /// infinity. Occlusion is not asked for.
  std::vector<glm::ivec2> pixelsSeen(const Camera& view) const;

  double nearDistance() const noexcept { return nearDistance_; }

 private:
  std::vector<Camera> cameras_;
  double nearDistance_;
};

}  // namespace ibr::app
