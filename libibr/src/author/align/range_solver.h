// SPDX-License-Identifier: Apache-2.0
// Solves ρ and a_i of a cell's points again after points moved.
//
// A scene stores the result of triangulation (ranges.h), not the swept depth that served as its prior. RangeSolver
// recovers the prior from the stored result, so that an unmoved point gets its stored ρ. The standard deviation of the
// swept depth follows from the stored uncertainties, a point's prior from its ρ.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "author/match/ranges.h"
#include "ibr/scene.h"

namespace ibr {

class RangeSolver {
 public:
  /// `frame`: camera in which `members` (pinholes at the matched size) are triangulated. Uses the mesh's ratio and ρ,
  /// and its uncertainty for points with use != 0 (empty: all). `match`: d × n, px of `members`. `widened`: the stored
  /// uncertainty is the output of widenUncertainty.
  RangeSolver(const Camera& frame, std::vector<Camera> members, const MorphMesh& mesh,
              const std::vector<std::vector<glm::dvec2>>& match, bool widened,
              const std::vector<std::uint8_t>& use = {});

  /// Solves a stored point from its matches at `pixels`, one in each member's image.
  RangeFit solve(std::size_t point, std::span<const glm::dvec2> pixels) const;
  /// Solves a new point with the prior `inverseDepth`. `spread`: uncertainty of the prior in addition to that of the
  /// swept depth.
  RangeFit solve(double inverseDepth, double spread, std::span<const glm::dvec2> pixels) const;
  /// Solves a point from its matches alone, without a prior.
  RangeFit solve(std::span<const glm::dvec2> pixels) const;
  /// Fit of the point at its stored matches.
  const RangeFit& before(std::size_t point) const { return before_[point]; }

  /// Width of a sweep level in inverse depth, estimated from the stored uncertainties; 0 if there is no estimate.
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
  double maxInverseDepth_ = 0;  // inverse depth
  double deviation_ = 0;        // standard deviation of all priors
};

}  // namespace ibr
