// SPDX-License-Identifier: Apache-2.0
#include "author/align/range_solver.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "author/geometry/posed_model.h"
#include "author/mesh/uncertainty.h"

namespace ibr {
namespace {

constexpr std::size_t kSamples = 64;  // points sampled to estimate the level of the sweep
constexpr int kHalvings = 30;         // bisection steps for the level
constexpr double kNoPrior = 1e3;      // standard deviation without a prior, as a multiple of the point's inverse depth

std::vector<glm::dvec2> pixelsOf(const std::vector<std::vector<glm::dvec2>>& match, std::size_t point) {
  std::vector<glm::dvec2> pixels;
  for (const auto& list : match) pixels.push_back(list[point]);
  return pixels;
}

// The part of each point's uncertainty that widenUncertainty adds from its neighbours.
std::vector<float> neighbourUncertainty(MorphMesh mesh) {
  std::ranges::fill(mesh.uncertainty, 0.0f);
  widenUncertainty(mesh, std::vector<double>(mesh.vertexCount(), 0.0));
  return mesh.uncertainty;
}

}  // namespace

RangeSolver::RangeSolver(const Camera& frame, std::vector<Camera> members, const MorphMesh& mesh,
                         const std::vector<std::vector<glm::dvec2>>& match, bool widened,
                         const std::vector<std::uint8_t>& use)
    : frame_(frame), members_(std::move(members)) {
  const std::size_t n = mesh.vertexCount(), d = members_.size();
  const glm::dvec3 axis = viewAxis(frame.pose);
  double largest = 0;
  for (std::size_t p = 0; p < n; ++p) {
    const double rho = mesh.inverseDistance[p];
    glm::dvec3 seen(0.0);  // ρ × the vector from the frame's centre to the point
    for (std::size_t i = 0; i < d; ++i) {
      const Pose& pose = members_[i].pose;
      const glm::dvec3 ray = pose.rotation * unproject(members_[i].intrinsics, match[i][p]);
      seen += (double(mesh.ratio[i][p]) * ray + rho * (pose.position - frame.pose.position)) / double(d);
    }
    const double depth = glm::dot(seen, axis);
    inverseDistance_.push_back(rho);
    inverseDepth_.push_back(depth > 0 ? rho / depth : 0.0);
    largest = std::max(largest, inverseDepth_[p]);
  }

  // σ² = σ_triangulation(level)² + (1.1 level)² if widened, without the neighbours' part. Increases with the level.
  const std::vector<float> neighbours = widened ? neighbourUncertainty(mesh) : std::vector<float>(n, 0.0f);
  std::vector<std::size_t> known;
  for (std::size_t p = 0; p < n; ++p)
    if ((use.empty() || use[p]) && inverseDistance_[p] > 0 &&
        double(mesh.uncertainty[p]) > 1.01 * double(neighbours[p]))
      known.push_back(p);
  std::vector<double> levels;
  const std::size_t stride = std::max<std::size_t>(1, known.size() / kSamples);
  for (std::size_t at = 0; at < known.size(); at += stride) {
    const std::size_t p = known[at];
    const std::vector<glm::dvec2> pixels = pixelsOf(match, p);
    const double own = std::sqrt(std::pow(double(mesh.uncertainty[p]), 2) - std::pow(double(neighbours[p]), 2));
    const auto uncertainty = [&](double level) {
      const double deviation = kPriorLevels * level;
      const RangeFit range = triangulate(frame_, members_, pixels, priorOf(p, pixels, deviation), kNoisePx);
      const double wide = widened ? kUncertaintyLevels * level * range.perInverseDepth : 0.0;
      return std::hypot(range.uncertainty, wide);
    };
    const double perInverseDepth =
        triangulate(frame_, members_, pixels, {inverseDepth_[p], 1.0}, kNoisePx).perInverseDepth;
    double low = 0, high = 4 * own / perInverseDepth;
    if (uncertainty(high) < own) continue;  // the match alone is as certain: the point says nothing about the level
    for (int step = 0; step < kHalvings; ++step) {
      const double middle = 0.5 * (low + high);
      (uncertainty(middle) < own ? low : high) = middle;
    }
    levels.push_back(high);
  }
  if (!levels.empty()) level_ = median(levels);
  maxInverseDepth_ = std::max(largest, 1e-9);
  deviation_ = level_ > 0 ? kPriorLevels * level_ : kNoPrior * maxInverseDepth_;
  for (std::size_t p = 0; p < n; ++p) {
    const std::vector<glm::dvec2> pixels = pixelsOf(match, p);
    prior_.push_back(priorOf(p, pixels, deviation_));
    before_.push_back(triangulate(frame_, members_, pixels, prior_[p], kNoisePx));
  }
}

// Finds the prior for which triangulation returns the stored ρ. Two secant steps suffice: ρ is nearly linear in it.
RangePrior RangeSolver::priorOf(std::size_t point, std::span<const glm::dvec2> pixels, double deviation) const {
  RangePrior prior{inverseDepth_[point], deviation};
  if (!(inverseDistance_[point] > 0)) return prior;
  const auto found = [&](double inverseDepth) {
    return triangulate(frame_, members_, pixels, {inverseDepth, deviation}, kNoisePx).inverseDistance;
  };
  for (int step = 0; step < 2; ++step) {
    const double here = found(prior.inverseDepth), there = found(prior.inverseDepth + deviation);
    const double slope = (there - here) / deviation;
    if (!(slope > 1e-6 * here / std::max(prior.inverseDepth, 1e-12)) || !(here > 0)) break;  // the match alone decides
    prior.inverseDepth += std::clamp((inverseDistance_[point] - here) / slope, -20 * deviation, 20 * deviation);
  }
  return prior;
}

RangeFit RangeSolver::solve(std::size_t point, std::span<const glm::dvec2> pixels) const {
  return triangulate(frame_, members_, pixels, prior_[point], kNoisePx);
}

RangeFit RangeSolver::solve(double inverseDepth, double spread, std::span<const glm::dvec2> pixels) const {
  return triangulate(frame_, members_, pixels, {inverseDepth, std::hypot(deviation_, spread)}, kNoisePx);
}

RangeFit RangeSolver::solve(std::span<const glm::dvec2> pixels) const {
  return triangulate(frame_, members_, pixels, {0.5 * maxInverseDepth_, kNoPrior * maxInverseDepth_}, kNoisePx);
}

}  // namespace ibr
