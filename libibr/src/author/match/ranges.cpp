// SPDX-License-Identifier: Apache-2.0
#include "author/match/ranges.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "author/geometry/mean_frame.h"

namespace ibr {
namespace {

constexpr double kMinRatio = 0.2, kMaxRatio = 5.0;  // range of a_i relative to their mean
constexpr int kSteps = 4;                           // of Gauss–Newton, which starts within a pixel

struct Fit {
  glm::dvec3 state;       // x, y, w
  glm::dmat3 covariance;  // for unit noise
  double residual = 0;    // maximum, px
};

}  // namespace

RangeFit triangulate(const Camera& frame, std::span<const Camera> members, std::span<const glm::dvec2> pixels,
                     const RangePrior& prior, double noisePx) {
  const std::size_t d = members.size();
  // (x, y, w) → member's homogeneous pixel: the frame's image with focal length 1 around its axis, y down.
  Camera unit = frame;
  unit.intrinsics.fx = unit.intrinsics.fy = 1;
  unit.intrinsics.cx = unit.intrinsics.cy = 0;
  std::vector<FrameToMember> maps;
  for (const Camera& member : members) maps.push_back(frameToMember(unit, member));

  // Start at the mean of the rays' directions, all brought to depth 1 along the frame's axis.
  glm::dvec3 state(0.0, 0.0, prior.inverseDepth);
  for (std::size_t i = 0; i < d; ++i) {
    // The ray of member i in the frame's image if the point were at the prior's depth.
    const glm::dvec3 ray = glm::inverse(maps[i].a) * (glm::dvec3(pixels[i], 1.0));
    const glm::dvec3 shift = glm::inverse(maps[i].a) * maps[i].b;
    // a·(x, y, 1) + w·b ∝ pixel: (x, y, 1) = scale·ray − w·shift.
    const double scale = (1.0 + prior.inverseDepth * shift.z) / ray.z;
    state.x += (scale * ray.x - prior.inverseDepth * shift.x) / double(d);
    state.y += (scale * ray.y - prior.inverseDepth * shift.y) / double(d);
  }

  const double priorWeight = noisePx * noisePx / (prior.deviation * prior.deviation);
  auto solve = [&](glm::dvec3 start, bool fixedDepth) {
    Fit fit{start, glm::dmat3(0.0), 0.0};
    for (int step = 0; step <= kSteps; ++step) {
      glm::dmat3 normal(0.0);
      glm::dvec3 gradient(0.0);
      fit.residual = 0;
      for (std::size_t i = 0; i < d; ++i) {
        const glm::dvec3 h = maps[i].homogeneous({fit.state.x, fit.state.y}, fit.state.z);
        if (!(h.z > 1e-9)) continue;
        const glm::dvec2 pixel(h.x / h.z, h.y / h.z), error = pixels[i] - pixel;
        fit.residual = std::max(fit.residual, glm::length(error));
        glm::dvec3 rows[2];
        for (int c = 0; c < 2; ++c) {
          const double q = c == 0 ? pixel.x : pixel.y;
          rows[c] = glm::dvec3(maps[i].a[0][c] - q * maps[i].a[0].z, maps[i].a[1][c] - q * maps[i].a[1].z,
                               maps[i].b[c] - q * maps[i].b.z) /
                    h.z;
          if (fixedDepth) rows[c].z = 0;
          normal += glm::outerProduct(rows[c], rows[c]);
          gradient += rows[c] * (c == 0 ? error.x : error.y);
        }
      }
      normal[2][2] += priorWeight;
      if (!fixedDepth) gradient.z += priorWeight * (prior.inverseDepth - fit.state.z);
      fit.covariance = glm::inverse(normal);
      if (step == kSteps) break;
      const glm::dvec3 change = fit.covariance * gradient;
      if (!std::isfinite(change.x + change.y + change.z)) break;
      fit.state += change;
    }
    return fit;
  };
  Fit fit = solve(state, false);
  if (!(fit.state.z >= 0)) fit = solve({fit.state.x, fit.state.y, 0.0}, true);  // divergent rays meet at infinity

  RangeFit range;
  const glm::dvec3 direction = frame.pose.rotation * glm::dvec3(fit.state.x, -fit.state.y, -1.0);
  double mean = 0;
  for (std::size_t i = 0; i < d; ++i) {
    range.ratio.push_back(glm::length(direction + fit.state.z * (frame.pose.position - members[i].pose.position)));
    mean += range.ratio.back() / double(d);
  }
  for (double& a : range.ratio) a = std::clamp(a / mean, kMinRatio, kMaxRatio);
  range.inverseDistance = std::max(fit.state.z, 0.0) / mean;
  range.perInverseDepth = 1.0 / mean;
  const double noise = std::max(fit.residual, noisePx);
  range.uncertainty = noise * std::sqrt(std::max(fit.covariance[2][2], 0.0)) / mean;
  range.residualPx = fit.residual;
  return range;
}

}  // namespace ibr
