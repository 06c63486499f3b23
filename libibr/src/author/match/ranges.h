// SPDX-License-Identifier: Apache-2.0
// Inverse distance ρ and ratios a_i of a match, for the morph formula (libibr/ARCHITECTURE.md).
//
// The frame sees the point in direction u = (x, −y, −1) at inverse depth w; member i sees u + w (C − c_i). (x, y, w) is
// the least-squares fit to the members' pixels, with the sweep's w as prior where the rays are nearly parallel. Then
// with v_i = |u + w (C − c_i)|: distance s_i = v_i / w, ρ = w / mean(v), a_i = v_i / mean(v), finite also at w = 0.
#pragma once

#include <span>
#include <vector>

#include "ibr/camera.h"

namespace ibr {

struct RangeFit {
  double inverseDistance = 0;  // ρ
  double uncertainty = 0;      // one standard deviation of ρ
  std::vector<double> ratio;   // a_i, mean 1
  double perInverseDepth = 0;  // change of ρ with the inverse depth along the frame's axis
  double residualPx = 0;       // maximum distance between a match and the projection of the fitted point
};

struct RangePrior {
  double inverseDepth = 0;  // along the frame's axis
  double deviation = 0;     // one standard deviation of inverseDepth, > 0
};

inline constexpr double kPriorLevels = 0.5;  // standard deviation of a sweep's depth, levels
inline constexpr double kNoisePx = 0.25;     // minimum standard deviation of a match

/// `frame` is the mean frame (its pixels are not used), `pixels` the match in each member's image. `noisePx`: the
/// assumed minimum standard deviation of a match.
RangeFit triangulate(const Camera& frame, std::span<const Camera> members, std::span<const glm::dvec2> pixels,
                     const RangePrior& prior, double noisePx);

}  // namespace ibr
