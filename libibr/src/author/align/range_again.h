// SPDX-License-Identifier: Apache-2.0
// ρ and a_i of a cell's points, solved again after points moved.
//
// A scene holds what triangulation found (ranges.h), not what it started from: the depth of the sweep. That is found
// again from the stored result, so that a point which did not move gets its stored ρ: the standard deviation of the
// sweep's depth from the stored uncertainties, a point's prior from its ρ.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "author/match/ranges.h"
#include "ibr/scene.h"

namespace ibr {

class RangeSolver {
 public:
  /// `frame`: what `members`, pinholes at the size that is matched, are triangulated in; the mesh's ratio and ρ are
  /// used, and its uncertainty for the points for which `use` is not 0 (none: all). `match`: d × n, px of `members`.
  /// `widened`: the uncertainty is that of widenUncertainty.
  RangeSolver(const Camera& frame, std::vector<Camera> members, const MorphMesh& mesh,
              const std::vector<std::vector<glm::dvec2>>& match, bool widened,
              const std::vector<std::uint8_t>& use = {});

  /// With the point's matches at `pixels`, one in each member's picture.
  RangeFit solve(std::size_t point, std::span<const glm::dvec2> pixels) const;
  /// A point that the mesh did not have, with the inverse depth that it should have, and how far that may be off
  /// besides what the sweep's depth is.
  RangeFit solve(double inverseDepth, double spread, std::span<const glm::dvec2> pixels) const;
  /// As far as the point's matches alone tell.
  RangeFit solve(std::span<const glm::dvec2> pixels) const;
  /// Where it stands now.
  const RangeFit& before(std::size_t point) const { return before_[point]; }

  /// One level of the sweep as inverse depth, as far as the stored uncertainties tell; 0: they tell nothing.
  double level() const { return level_; }

 private:
  RangePrior priorOf(std::size_t point, std::span<const glm::dvec2> pixels, double deviation) const;

  Camera frame_;
  std::vector<Camera> members_;
  std::vector<double> inverseDepth_;     // of the stored points, along the frame's axis
  std::vector<double> inverseDistance_;  // stored ρ
  std::vector<RangePrior> prior_;
  std::vector<RangeFit> before_;
  double level_ = 0;
  double largest_ = 0;    // inverse depth
  double deviation_ = 0;  // of all priors
};

}  // namespace ibr
